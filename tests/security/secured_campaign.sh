#!/usr/bin/env bash
# Secured runs on hosts of their own whose links lose packets: the sources of a bench, the analysis
# and `dyncal run` on a host each. Each run must end with 0 and have the points and transfer
# function of `dyncal analyse`, to the last bit. The long form of what is tested, outside the test
# command.
#
#   secured_campaign.sh --programs DIR [OPTION...]
#     --orders "SA..."  DDS of sources (and `dyncal run`) and analysis: F Fast DDS, C Cyclone DDS
#                       (CC FF CF FC)
#     --loss "N..."     packets of a hundred that each host loses of what comes to it (0 3); each IP
#                       fragment is one
#     --runs N          of each order and loss (12)
#     --plain           the same without security, to compare with
#
# Prints a row of a table for each order and loss: complete runs, median and longest time of a run
# in s, processor time of sources and analysis in s a run. Fails when a run was not complete.
#
# Needs root, ip, tc, nft and python3; exits with 77 (skipped) and one line otherwise.
set -euo pipefail

. "$(dirname "${BASH_SOURCE[0]}")/../interop/two_versions.sh"
orders="CC FF CF FC" losses="0 3" runs=12 plain=
while (($#)); do
  case $1 in
  --programs) programs[this]=$(realpath "$2") && shift ;;
  --orders) orders=$2 && shift ;;
  --loss) losses=$2 && shift ;;
  --runs) runs=$2 && shift ;;
  --plain) plain=yes ;;
  *) echo "unknown option $1" && exit 2 ;;
  esac
  shift
done
[[ ${programs[this]:-} ]] || { echo "--programs DIR is needed" && exit 2; }
make_hosts "secured runs" bench analysis operator
command -v python3 >/dev/null || skip "there is no command python3"
write_bench

dyncal() { "${programs[this]}/dyncal" "$@" >"$folder/log"; }
dyncal analyse "$folder/bench.toml" --output "$folder/expected.json"
dyncal security init "$folder/authority"
dyncal security issue "$folder/authority" source --bench mixed --output "$folder/source"
dyncal security issue "$folder/authority" analysis --output "$folder/analysis"
dyncal security issue "$folder/authority" operator --bench mixed --output "$folder/operator"
secured_by() { [[ $plain ]] || echo "--security $folder/$1"; }

lose() { # percent of the packets, before they are put together
  local host
  for host in "${hosts[@]}"; do
    run_on "$host" nft flush ruleset
    (($1 == 0)) || run_on "$host" nft "table netdev lossy { chain input {
        type filter hook ingress device lab priority 0;
        ip protocol udp numgen random mod 100 < $1 counter drop
      }; }" || skip "nft cannot drop packets here"
  done
}

processor_s() { # of the services
  local pid ticks=0
  for pid in "${services[@]}"; do
    ticks=$((ticks + $(awk '{print $14 + $15}' "/proc/$pid/stat" 2>/dev/null || echo 0)))
  done
  awk "BEGIN {print $ticks / $(getconf CLK_TCK)}"
}

complete=0
one_run() { # vendor of dyncal run
  local status=0 difference begin_s=$EPOCHREALTIME
  rm -f "$folder/run.json"
  # shellcheck disable=SC2046
  run_on operator timeout 180 "${programs[this]}/dyncal" run "$folder/bench.toml" --output \
    "$folder/run.json" "${network[@]}" --dds "$1" $(secured_by operator) \
    >/dev/null 2>"$folder/run.log" || status=$?
  awk "BEGIN {print $EPOCHREALTIME - $begin_s}" >>"$folder/times"
  difference=$(compare "$folder/expected.json" "$folder/run.json" 2>&1) || difference+=" "
  if [[ $status == 0 && -z $difference ]]; then
    complete=$((complete + 1))
  else
    echo "  FAILED: exit status $status; ${difference:0:300}"
    grep -v "^$" "$folder/run.log" | tail -2 | cut -c 1-300
  fi
}

failed=0
echo "| sources, analysis | loss | complete | time of a run | longest | processor time of a run |"
echo "|---|---|---|---|---|---|"
for order in $orders; do
  for loss in $losses; do
    lose "$loss"
    complete=0
    : >"$folder/times"
    # shellcheck disable=SC2046
    begin analysis this dyncal-analysis "${order:1:1}" "analysis ready" $(secured_by analysis)
    # shellcheck disable=SC2046
    begin bench this dyncal-acs "${order:0:1}" ", source " "$folder/bench.toml" $(secured_by source)
    for ((run = 0; run < runs; run++)); do
      one_run "$(vendor_of "${order:0:1}")"
    done
    used_s=$(processor_s)
    end_services
    ((complete == runs)) || failed=$((failed + 1))
    sort -n "$folder/times" | awk -v what="$order | $loss % | $complete of $runs" \
      -v used="$used_s" -v runs="$runs" '{at[NR] = $1} END {
        printf "| %s | %.1f s | %.1f s | %.2f s |\n", what, at[int((NR + 1) / 2)], at[NR],
          used / runs}'
  done
done
exit "$((failed > 0))"
