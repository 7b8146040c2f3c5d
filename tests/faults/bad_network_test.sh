#!/usr/bin/env bash
# Runs over a bad network: the sources of a bench, the analysis and `dyncal run` on a host each.
# Every run must end with 0, with no sample lost, and with the results of `dyncal analyse` of the
# same records to the last bit.
#
#   bad_network_test.sh FOLDER_OF_PROGRAMS [OPTION...]
#     --runs N           of each case (1)
#     --loss "P..."      percent of the packets, both ways; with repeated and overtaken ones (20)
#     --mbit "M..."      of each host's link; 0: unlimited (0)
#     --vendors "SAR..." of sources, analysis, run: F Fast DDS, C Cyclone DDS (FCF CFC)
#     --speed N          how many times faster than recorded (2)
#     --acs-rate HZ      of two channels (20000)
#     --takeover SECONDS after the start of a run another analysis is started, and the one that
#                        serves the run is killed (0: not)
#     --garbage KIND     5000 malformed packets a second to the bench's and the analysis' host each
#                        (rtps_garbage.py): each service must refuse some, and none may end or grow
#                        by 100 MB
#
# The long form, 960 runs (two readers of Fast DDS, the analysis and what records the run, each get
# the samples by themselves: real time is what fits 10 Mbit/s):
#   bad_network_test.sh build/bin --runs 20 --loss "0 3 10 20" --mbit "0 100"
#     --vendors "FFF CCC FCF CFC" --speed 4
#   bad_network_test.sh build/bin --runs 20 --loss "0 3 10 20" --mbit 10
#     --vendors "FFF CCC FCF CFC" --speed 1
# and of taking over on a narrow link:
#   bad_network_test.sh build/bin --runs 20 --loss "0 3" --mbit "20 10" --takeover 8 --speed 1
#     --acs-rate 50000 --vendors "FFF CCC FCF CFC"
#
# and of garbage (a mutated packet may be taken for a real one and stop a run, which then says so):
#   bad_network_test.sh build/bin --runs 10 --loss 0 --garbage header --vendors "FFF CCC"
#
# Needs root, ip, tc, nft and python3; exits with 77 (skipped) and one line otherwise.
set -euo pipefail

programs=$1
shift
runs=1 losses=20 links=0 orders="FCF CFC" speed=2 acs_rate=20000 takeover=0 garbage=
while (($# > 1)); do
  case $1 in
  --runs) runs=$2 ;;
  --loss) losses=$2 ;;
  --mbit) links=$2 ;;
  --vendors) orders=$2 ;;
  --speed) speed=$2 ;;
  --acs-rate) acs_rate=$2 ;;
  --takeover) takeover=$2 ;;
  --garbage) garbage=$2 ;;
  *) echo "unknown option $1" && exit 2 ;;
  esac
  shift 2
done

here=$(dirname "${BASH_SOURCE[0]}")
. "$here/bad_network.sh"
make_hosts "dyncal run over a bad network" bench analysis operator
command -v python3 >/dev/null || skip "there is no command python3"

"$programs/dyncal-virtual-bench" --preset mpu9250-ptb --seed 3 --record-csv "$folder" \
  --adc-file "$folder/adc.json" --frequencies 20,80,160 --levels 10,100,100 --repetitions 2 \
  --settling 0.5 --duration-per-step 2.0 --acs-rate "$acs_rate" 2>"$folder/log"
cat >"$folder/bench.toml" <<TOML
bench = "far"
[excitation]
frequencies_hz = ["20", "80", "160"]
level = [10.0, 100.0, 100.0]
repetitions = 2
settling_s = 0.5
duration_s = 1.5
[sources.dau]
driver = "file"
path = "dau.csv"
play = $speed
units = { acceleration_x = "m/s^2", acceleration_y = "m/s^2", acceleration_z = "m/s^2", sync = "V" }
[sources.acs]
driver = "file"
path = "acs.csv"
play = $speed
units = { reference = "m/s^2", sync = "V" }
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_x", "dau/acceleration_y", "dau/acceleration_z"]
[corrections]
adc = { file = "adc.json", channel = "ADC1" }
[uncertainty]
reference_magnitude_rel = 5e-4
reference_phase_rad = 5e-4
acs_delay_s = 1e-8
TOML
"$programs/dyncal" analyse "$folder/bench.toml" --output "$folder/expected.json" >"$folder/log"

name_of() { [[ $1 == F ]] && echo fastdds || echo cyclonedds; }
network=(--domain 46 --interface lab)
declare -A services=()
begin() { # host, program, vendor, what it says when it is ready, arguments
  : >"$folder/$2.log"
  (on "$1" "$programs/$2" "${@:5}" "${network[@]}" --dds "$(name_of "$3")" \
    >/dev/null 2>"$folder/$2.log") &
  services[$2]=$!
  for ((i = 0; i < 600; i++)); do
    grep -q "$4" "$folder/$2.log" && return
    sleep 0.1
  done
  echo "  FAILED: $2 is not ready" && tail -3 "$folder/$2.log" && exit 1
}
end_services() {
  kill "${services[@]}" 2>/dev/null || true
  wait "${services[@]}" 2>/dev/null || true
  services=()
}
replace_analysis() {
  local old=${services[dyncal-analysis]}
  begin analysis dyncal-analysis "${order:1:1}" "analysis ready"
  kill -9 "$old"
  wait "$old" 2>/dev/null || true
}

senders=() # of garbage
begin_garbage() {
  [[ -n $garbage ]] || return 0
  (on bench "$here/rtps_garbage.py" "${address[analysis]}" 46 "$garbage" 5000) &
  senders=("$!")
  (on analysis "$here/rtps_garbage.py" "${address[bench]}" 46 "$garbage" 5000) &
  senders+=("$!")
}
resident_mb() { awk '/VmRSS/ {printf "%d", $2 / 1024}' "/proc/$1/status" 2>/dev/null || true; }
check_services() {
  [[ -n $garbage ]] || return 0
  local service sender now
  for service in dyncal-analysis dyncal-acs; do
    now=$(resident_mb "${services[$service]}")
    echo "  $service: ${before[$service]} MB before $garbage packets, ${now:-ended} MB after"
    ((${now:-100000} < before[$service] + 100)) || failed=$((failed + 1))
    grep -q "refused a packet" "$folder/$service.log" || {
      echo "  FAILED: $service has refused no packet" && failed=$((failed + 1))
    }
  done
  for sender in "${senders[@]}"; do
    kill -0 "$sender" 2>/dev/null || {
      echo "  FAILED: a sender of $garbage packets has ended" && failed=$((failed + 1))
    }
  done
}

# One line: what is not as it must be; nothing if all is. Fails when it cannot tell.
compare() {
  python3 - "$folder/expected.json" "$folder/run.json" <<'PYTHON'
import json, sys
expected, found = (json.load(open(path)) for path in sys.argv[1:])
points = expected["points"]
if len(points) != 18 or not expected["transfer_function"]:
    sys.exit("nothing to compare with")
bad = [one for one, other in zip(found["points"], points) if one != other]
if len(found["points"]) != len(points) or bad:
    lost = sum(one["lost"] for one in found["points"])
    what = [bad[0].get("problem", ""), bad[0].get("flags", "")] if bad else []
    print(f"{len(found['points'])} points, {len(bad)} differ, {lost} samples lost;", *what)
elif found["transfer_function"] != expected["transfer_function"]:
    print("the transfer function differs")
PYTHON
}

failed=0
began=0
one_run() {
  rm -f "$folder/run.json"
  local status=0 difference=
  (on operator timeout 300 "$programs/dyncal" run "$folder/bench.toml" --output \
    "$folder/run.json" "${network[@]}" --dds "$(name_of "${order:2:1}")" \
    >/dev/null 2>"$folder/run.log") &
  local run=$!
  if [[ $takeover != 0 ]]; then
    sleep "$takeover" # into the run: the time of a fault
    replace_analysis
  fi
  wait "$run" || status=$?
  if [[ ! -s $folder/run.json ]]; then
    difference="no result"
  elif ! difference=$(compare); then
    difference="the results cannot be compared"
  fi
  began=$((began + 1))
  if [[ $takeover != 0 ]] && ! grep -q "taken over" "$folder/dyncal-analysis.log"; then
    difference+=" the run was not taken over"
  fi
  if [[ $status != 0 || -n $difference ]]; then
    echo "  FAILED: exit status $status; $difference"
    grep -v "^$" "$folder/run.log" | tail -3 | cut -c 1-300
    failed=$((failed + 1))
    return 1
  fi
}

for order in $orders; do
  for mbit in $links; do
    limit "$mbit"
    for loss in $losses; do
      disturb "$loss"
      begin analysis dyncal-analysis "${order:1:1}" "analysis ready"
      begin bench dyncal-acs "${order:0:1}" ", source " "$folder/bench.toml"
      whole=0
      begin_s=$SECONDS
      declare -A before=()
      for service in "${!services[@]}"; do
        before[$service]=$(resident_mb "${services[$service]}")
      done
      begin_garbage
      for ((n = 0; n < runs; n++)); do
        one_run && whole=$((whole + 1)) || true
      done
      memory=$(awk '/VmHWM/ {printf "%d MB", $2 / 1024}' \
        "/proc/${services[dyncal-analysis]}/status" 2>/dev/null || true)
      echo "$order, loss $loss %, ${mbit/#0/unlimited} Mbit/s: $whole of $runs runs whole," \
        "$((SECONDS - begin_s)) s; analysis at most ${memory:-gone}"
      ((loss == 0)) || report_lost_packets >"$folder/lost" || {
        echo "  FAILED: no packet was lost" && failed=$((failed + 1))
      }
      check_services
      end_services
      jobs -p | xargs -r kill 2>/dev/null || true # the garbage
      wait
    done
  done
done
((began > 0)) || failed=1
exit "$((failed > 0))"
