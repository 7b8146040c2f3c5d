# Hosts on a network that loses, repeats and delays packets and has little room; to be sourced.
# Each host is a network namespace with an interface `lab` at a switch. Needs root, ip, tc and nft;
# otherwise the test ends with 77 (skipped) and one line. Nothing is left behind.
#
#   make_hosts SUBJECT NAME...    SUBJECT: what is not tested when it is skipped
#   disturb LOSS_PERCENT [LOST]   each host loses so many of the packets that come to it, those of
#                                 UDP or of the protocols LOST ("udp, tcp"); unless it is 0, 3 %
#                                 come twice and 5 % later than those behind them
#   limit MBIT_PER_S              each host's link, both ways; 0: unlimited
#   on HOST COMMAND...            a command there (in a subshell, it becomes the command)
#
# Sets $folder, removed at the end, and the associative array address. disturb and limit also serve
# who has made hosts otherwise (hosts.py), and has set hosts, address and prefix, with which the
# names of their namespaces begin.
skip() {
  echo "SKIPPED: $subject is not tested: $1"
  exit 77
}

remove_hosts() {
  for host in "${hosts[@]}" switch; do
    ip netns pids "$prefix-$host" 2>/dev/null | xargs -r kill -9 2>/dev/null || true
    ip netns delete "$prefix-$host" 2>/dev/null || true
  done
  rm -rf "$folder"
}

on() { exec ip netns exec "$prefix-$1" "${@:2}"; }
run_on() { ip netns exec "$prefix-$1" "${@:2}"; }

make_hosts() {
  subject=$1
  prefix=bad-$$
  shift
  hosts=("$@")
  [[ $(id -u) == 0 ]] || skip "it needs root"
  for tool in ip tc nft; do command -v "$tool" >/dev/null || skip "there is no command $tool"; done
  folder=$(mktemp -d)
  export DYNCAL_RUNS=$folder/runs
  declare -gA address=()
  trap remove_hosts EXIT
  local host last=1
  for host in "${hosts[@]}" switch; do
    ip netns add "$prefix-$host" 2>/dev/null || skip "this machine makes no network namespaces"
    ip -n "$prefix-$host" link set lo up
  done
  ip -n "$prefix-switch" link add switch type bridge || skip "this machine makes no bridges"
  ip -n "$prefix-switch" link set switch up
  for host in "${hosts[@]}"; do
    address[$host]=10.98.0.$last
    last=$((last + 1))
    ip -n "$prefix-$host" link add lab type veth peer name "to-$host" netns "$prefix-switch" ||
      skip "this machine makes no veth interfaces"
    ip -n "$prefix-switch" link set "to-$host" master switch up
    ip -n "$prefix-$host" address add "${address[$host]}/24" dev lab
    ip -n "$prefix-$host" link set lab up
  done
  # A participant uses the interfaces that are up when it is made.
  local i
  for host in "${hosts[@]}"; do
    for ((i = 0; i < 1200; i++)); do
      ip -n "$prefix-$host" -br link show lab | grep -q LOWER_UP && break
      sleep 0.05
    done
  done
}

disturb() {
  local host other repeats lost=${2:-udp}
  for host in "${hosts[@]}"; do
    run_on "$host" nft flush ruleset
    run_on switch nft "flush ruleset"
  done
  (($1 > 0)) || return 0
  for host in "${hosts[@]}"; do
    # Band 1:20 of the interface is slow: what is in it is overtaken (see limit).
    run_on "$host" nft "table ip bad {
      chain input {
        type filter hook input priority 0;
        iifname lab meta l4proto { $lost } numgen random mod 100 < $1 counter drop
      };
      chain output {
        type route hook output priority 0;
        oifname lab meta l4proto udp numgen random mod 100 < 5 meta priority set 0x00010020
      }; }" ||
      skip "nft cannot drop or delay packets here"
    repeats=
    for other in "${hosts[@]}"; do
      [[ $other == "$host" ]] ||
        repeats+="
        ip daddr ${address[$other]} numgen random mod 100 < 3 dup to to-$other"
    done
    run_on switch nft "table netdev bad_$host { chain repeat {
        type filter hook ingress device to-$host priority 0;$repeats
      }; }" ||
      skip "nft cannot repeat packets here"
  done
}

limit() {
  local host rate=$(($1 > 0 ? $1 : 10000))mbit
  for host in "${hosts[@]}"; do
    run_on "$host" tc qdisc delete dev lab root 2>/dev/null || true
    run_on switch tc qdisc delete dev "to-$host" root 2>/dev/null || true
    {
      run_on "$host" tc qdisc add dev lab root handle 1: htb default 10 r2q 1000 &&
        run_on "$host" tc class add dev lab parent 1: classid 1:1 htb rate "$rate" &&
        run_on "$host" tc class add dev lab parent 1:1 classid 1:10 htb rate "$rate" &&
        run_on "$host" tc class add dev lab parent 1:1 classid 1:20 htb rate 5mbit ceil 5mbit &&
        run_on "$host" tc qdisc add dev lab parent 1:20 pfifo limit 20
    } 2>/dev/null || skip "tc cannot limit a link here"
    (($1 == 0)) || run_on switch tc qdisc add dev "to-$host" root tbf rate "$rate" burst 16kb \
      latency 200ms || skip "tc cannot limit a link here"
  done
}

# Fails when nothing was lost although it should have been.
report_lost_packets() {
  local host lost=0
  for host in "${hosts[@]}"; do
    lost=$((lost + $(run_on "$host" nft list ruleset |
      sed -n 's/.*counter packets \([0-9]*\).*/\1/p' | head -1)))
  done
  echo "$lost packets were lost on the way"
  ((lost > 0))
}
