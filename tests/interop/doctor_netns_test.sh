#!/usr/bin/env bash
# `dyncal doctor` on one host, an analysis and a source on another (network namespaces with host
# names of their own), for every pair of vendors: a sound network, a network without multicast, a
# firewall that lets discovery through but no messages, a bench file that differs, and losses in one
# direction.
#
#   doctor_netns_test.sh FOLDER_OF_PROGRAMS [VENDOR...]
#
# Needs root, ip, nft, unshare and python3; exits with 77 (skipped) and one line otherwise. Leaves
# no namespace behind.
set -euo pipefail

programs=$1
shift
vendors=("${@:-fastdds cyclonedds}")
read -ra vendors <<<"${vendors[*]}"

. "$(dirname "${BASH_SOURCE[0]}")/lossy_link.sh"
make_lossy_link 0 "dyncal doctor between network namespaces"
unshare --uts true 2>/dev/null || skip "this machine gives a process no host name of its own"

cat >"$folder/bench.toml" <<'TOML'
bench = "netns"
[excitation]
frequencies_hz = ["10"]
level = 1.0
[sources.acs]
driver = "file"
path = "record.csv"
serial = "7"
units = { reference = "m/s^2", dut = "V" }
[method]
kind = "analogue"
reference = "acs/reference"
dut = ["acs/dut"]
TOML
sed 's/serial = "7"/serial = "8"/' "$folder/bench.toml" >"$folder/other.toml"
printf 't_ns,reference,dut\n0,0,0\n1000000,1,1\n2000000,0,0\n' >"$folder/record.csv"

network=(--domain 45 --peer "${address[0]}" --peer "${address[1]}" --interface lab)
on_host() { # namespace, host name, command...; in a subshell, which becomes the command
  exec ip netns exec "$1" unshare --uts sh -c 'hostname "$0"; exec "$@"' "${@:2}"
}
begin() { # program, options...
  (on_host "$writing" lab-2 "$programs/$1" "${@:2}" "${network[@]}" 2>>"$folder/log") &
  services+=($!)
}
failed=0
declare -A lines=([dyncal-analysis]=0 [dyncal-acs]=0)
wrong() {
  echo "  FAILED: $1"
  sed 's/^/    /' "$folder/report"
  failed=1
}
doctor() { # what, exit status, text of a finding, options...
  echo "  $1"
  local status=0
  (on_host "$reading" lab-1 "$programs/dyncal" doctor "${@:4}" --dds "$to" "${network[@]}" \
    >"$folder/report" 2>>"$folder/log") || status=$?
  [[ $status == "$2" ]] || wrong "exit status $status, not $2"
  grep -q -- "$3" "$folder/report" || wrong "no finding with '$3'"
}
drop() { # rule
  ip netns exec "$reading" nft "table ip doctor { chain input {
    type filter hook input priority 0; $1 drop; }; }"
}
lose() { # namespace that receives; a tenth of the packets to it
  ip netns exec "$1" nft "table ip doctor { chain input {
    type filter hook input priority 0;
    iifname lab meta l4proto udp numgen random mod 100 < 10 counter drop; }; }"
}
let_through_to() { ip netns exec "$1" nft delete table ip doctor; }
# Both services have a percentage of losses in this range, of 100 probes or more.
losses() { # least, most
  python3 - "$folder/report" "$@" <<'PYTHON' || wrong "other losses than $*"
import json, sys

least, most = (float(one) for one in sys.argv[2:])
losses = json.load(open(sys.argv[1], encoding="utf-8"))["losses"]
right = len(losses) == 2
for loss in losses:
    print("   ", loss)
    right &= loss["probes"] >= 100 and least <= loss["lost_percent"] <= most
sys.exit(not right)
PYTHON
}
let_through() { ip netns exec "$reading" nft delete table ip doctor; }

for from in "${vendors[@]}"; do
  for to in "${vendors[@]}"; do
    echo "services with $from, doctor with $to"
    services=()
    begin dyncal-analysis --dds "$from"
    begin dyncal-acs "$folder/bench.toml" --dds "$from"
    doctor "the clock of another host" 0 "the clock of lab-2 is [+-]0\.00" --seconds 4
    for program in dyncal-analysis dyncal-acs; do
      said=$(grep -c "$program info: not secured" "$folder/log") || true
      [[ $said == "$((++lines[$program]))" ]] || wrong "$program: $said times 'not secured'"
    done
    doctor "who is there, and that the bench file is the same" 0 \
      "all sources of .* are there, and their services have read this file" \
      "$folder/bench.toml" --seconds 4
    doctor "a bench file that differs" 3 'netns/acs.* on lab-2\|key .sources.acs.serial. is "7"' \
      "$folder/other.toml" --seconds 4
    drop "ip daddr 239.255.0.1"
    doctor "no multicast" 5 "no multicast comes from dyncal-a" --seconds 4
    let_through
    # Domain 45 has its ports from 18650; odd ones take messages.
    drop "iifname lab udp dport { 18661, 18663, 18665, 18667, 18669, 18671 }"
    doctor "a firewall before the messages" 3 "must let UDP 18650 to 18723 through" --seconds 4
    let_through
    ip netns exec "$writing" nft "table ip doctor { chain input {
      type filter hook input priority 0; iifname lab ip length > 1300 drop; }; }"
    # Fast DDS does not even tell of its readers then, so that only a possible cause can be named.
    doctor "a way that drops long packets" 3 "MTU" --seconds 6
    let_through_to "$writing"
    doctor "no losses" 0 '"losses"' --seconds 5 --json
    losses 0 0
    lose "$writing"
    doctor "losses on the way there" 5 '"losses"' --seconds 10 --json
    losses 5 16
    let_through_to "$writing"
    lose "$reading"
    doctor "losses on the way back" 5 '"losses"' --seconds 10 --json
    losses 5 16
    let_through_to "$reading"
    drop "iifname lo udp dport 18650-18723" # as own firewalls do that forget loopback
    doctor "a firewall before the own packets" 0 "all sources\|the clock of lab-2" \
      "$folder/bench.toml" --seconds 4
    let_through
    kill "${services[@]}" 2>/dev/null || true
    wait "${services[@]}" 2>/dev/null || true
  done
done
exit "$failed"
