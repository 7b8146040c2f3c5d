#!/usr/bin/env bash
# Programs of two versions, or of two releases of Debian, beside each other in one laboratory: the
# sources of a bench, the analysis and `dyncal run` on a host each, of either version, in every mix
# of vendors. The long form of what is tested, outside the test command.
#
#   side_by_side.sh --this DIR --other DIR [OPTION...]
#     --this-system ROOT, --other-system ROOT, --this-name NAME, --other-name NAME
#                        see two_versions.sh
#     --vendors "SAR..."  of sources, analysis, run: F Fast DDS, C Cyclone DDS (all eight)
#     --secured yes      each program by the folder of its role, which this version issues, and
#                        over Cyclone DDS alone: Fast DDS 3 talks to no other secured DDS
#     --write PAGE       puts the table into PAGE, between the lines
#                        <!-- side by side: NAMES[, secured] --> and <!-- end -->
#
# A mix is "yes" where each run ends with 0 and has the points and transfer function of `dyncal
# analyse` of the analysis' version, to the last bit in all that both versions write; "refused"
# where each run ends with a sentence on versions or contracts. Anything else is a failure. The last
# lines are the table.
#
# Needs root, ip, tc, nft and python3; exits with 77 (skipped) and one line otherwise.
set -euo pipefail

. "$(dirname "${BASH_SOURCE[0]}")/two_versions.sh"
orders="CCC FFF CCF CFC FCC CFF FCF FFC" page= secured=
while (($# > 1)); do
  case $1 in
  --vendors) orders=$2 ;;
  --write) page=$2 ;;
  --secured) secured=", secured" orders=CCC ;;
  *) take_side_option "$@" || { echo "unknown option $1" && exit 2; } ;;
  esac
  shift 2
done
prepare_sides "programs side by side" bench analysis operator

security() { "${programs[this]}/dyncal" security "$@" >"$folder/log"; }
if [[ $secured ]]; then
  security init "$folder/authority"
  security issue "$folder/authority" analysis --output "$folder/analysis"
  security issue "$folder/authority" source --bench mixed --output "$folder/source"
  security issue "$folder/authority" operator --bench mixed --output "$folder/operator"
fi
secured_by() { [[ -z $secured ]] || echo "--security $folder/$1"; }

for side in this other; do
  "${programs[$side]}/dyncal" analyse "$folder/bench.toml" --output "$folder/expected-$side.json" \
    >"$folder/log"
done
between=$(compare "$folder/expected-this.json" "$folder/expected-other.json")
echo "dyncal analyse of both: ${between:-the same bits}"

# yes, refused or FAILED, of one run in the order of vendors $4.
outcome=
one_run() { # sides of sources, analysis, run
  local status=0 difference="no result"
  rm -f "$folder/run.json"
  # shellcheck disable=SC2046
  begin analysis "$2" dyncal-analysis "${4:1:1}" "analysis ready" $(secured_by analysis)
  # shellcheck disable=SC2046
  begin bench "$1" dyncal-acs "${4:0:1}" ", source " "$folder/bench.toml" $(secured_by source)
  # shellcheck disable=SC2046
  run_on operator timeout 120 "${programs[$3]}/dyncal" run "$folder/bench.toml" --output \
    "$folder/run.json" "${network[@]}" --dds "$(vendor_of "${4:2:1}")" \
    $(secured_by operator) >/dev/null 2>"$folder/run.log" || status=$?
  end_services
  if [[ -s $folder/run.json ]]; then
    difference=$(compare "$folder/expected-$2.json" "$folder/run.json" 2>&1) || difference+=" "
  fi
  if [[ $status == 0 && -z $difference ]]; then
    outcome=yes
  elif [[ $status != 0 ]] &&
    grep -hE "contract|version" "$folder/run.log" "$folder"/dyncal-*.log >"$folder/refusal"; then
    outcome=refused
  else
    outcome=FAILED
    echo "  FAILED: exit status $status; $difference"
    grep -hv "^$" "$folder/run.log" | tail -3 | cut -c 1-300
  fi
}

failed=0
table=$folder/table
{
  echo "| sources | analysis | \`dyncal run\` | together |"
  echo "|---|---|---|---|"
} >"$table"
for sides in "this this this" "other this this" "this other this" "this this other" \
  "this other other" "other this other" "other other this" "other other other"; do
  read -r sources analysis run <<<"$sides"
  outcomes=()
  for order in $orders; do
    one_run "$sources" "$analysis" "$run" "$order"
    echo "$sides, $order: $outcome"
    [[ $outcome != FAILED ]] || failed=$((failed + 1))
    outcomes+=("$outcome")
  done
  every=$(printf '%s\n' "${outcomes[@]}" | sort -u | paste -sd ' ')
  [[ $every != refused ]] || echo "  refused: $(head -n 1 "$folder/refusal" | cut -c 1-200)"
  [[ $every != *\ * ]] || failed=$((failed + 1)) # a vendor makes a difference
  echo "| ${name[$sources]} | ${name[$analysis]} | ${name[$run]} | $every |" >>"$table"
done
cat "$table"
if [[ $page && $failed -eq 0 ]]; then
  sed -i -e "/^<!-- side by side: ${name[this]}, ${name[other]}$secured -->\$/,/^<!-- end -->\$/{
    /^<!-- side by side/r $table
    /^<!--/!d
  }" "$page"
fi
exit "$((failed > 0))"
