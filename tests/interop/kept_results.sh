#!/usr/bin/env bash
# What a laboratory has kept, after an upgrade and a downgrade: run folder, recording and store made
# by the programs of one version (--other), read by those of a newer one (--this), and the other way
# round. The long form of what is tested, outside the test command.
#
#   kept_results.sh --this DIR --other DIR [OPTION of two_versions.sh...]
#
# Held: after the upgrade history, report and evaluation of the recording have the older version's
# values to the last digit; what the newer one has written since is read by the older one with the
# newer one's values, or refused with a sentence; both refuse a store whose version is raised.
#
# Needs root, ip, tc, nft and python3; exits with 77 (skipped) and one line otherwise.
set -euo pipefail

. "$(dirname "${BASH_SOURCE[0]}")/two_versions.sh"
while (($# > 1)); do
  take_side_option "$@" || { echo "unknown option $1" && exit 2; }
  shift 2
done
prepare_sides "what was kept" laboratory

fail() {
  echo "kept_results.sh: $*" >&2
  exit 1
}
dyncal() { "${programs[$1]}/dyncal" "${@:2}"; }
keep_run() { # side, name
  begin laboratory "$1" dyncal-analysis C "analysis ready"
  begin laboratory "$1" dyncal-acs C ", source " "$folder/bench.toml"
  run_on laboratory timeout 120 "${programs[$1]}/dyncal" run "$folder/bench.toml" --run "$2" \
    "${network[@]}" >"$folder/log" 2>&1 || fail "no run $2: $(tail -n 3 "$folder/log")"
  end_services
}
# The history as one version reads it, a line a value.
history() { # side, file
  dyncal "$1" history dau --json >"$2.json" 2>"$folder/refusal" || return 1
  python3 - "$2.json" >"$2" <<'PYTHON'
import json, sys

def leaves(value, at=""):
    if isinstance(value, dict):
        for key in value:
            yield from leaves(value[key], f"{at}.{key}")
    elif isinstance(value, list):
        for number, one in enumerate(value):
            yield from leaves(one, f"{at}[{number}]")
    else:
        yield f"{at} {value!r}"

lines = list(leaves(json.load(open(sys.argv[1]))))
if sum("magnitude" in one for one in lines) < 9:
    sys.exit("the history has no values")
print(*lines, sep="\n")
PYTHON
}

keep_run other before
history other "$folder/before" || fail "$(cat "$folder/refusal")"
kept=$(echo "$folder"/runs/mixed/before*)

history this "$folder/after" || fail "the upgrade refuses the store: $(cat "$folder/refusal")"
lost=$(comm -23 <(sort "$folder/before") <(sort "$folder/after"))
[[ -z $lost ]] || fail "the upgrade changes or loses $(wc -l <<<"$lost") values: ${lost:0:200}"
dyncal this report "$kept" --no-pdf >"$folder/log" 2>&1 || fail "no report: $(cat "$folder/log")"
dyncal this analyse "$kept/recording.mcap" --output "$folder/again.json" >"$folder/log" 2>&1 ||
  fail "the recording is not evaluated: $(tail -n 3 "$folder/log")"
difference=$(compare "$kept/result.json" "$folder/again.json")
[[ -z $difference ]] || fail "of the recording: $difference"
echo "upgrade: $(wc -l <"$folder/before") values of the history and 18 points of the recording" \
  "equal to the last digit; a report is made"

keep_run this since
if history other "$folder/back"; then
  history this "$folder/after"
  lost=$(comm -23 <(sort "$folder/back") <(sort "$folder/after"))
  [[ -z $lost ]] || fail "the older one reads other values: ${lost:0:200}"
  echo "downgrade: the store is read, with equal values"
else
  grep -q "newer dyncal" "$folder/refusal" || fail "no sentence: $(cat "$folder/refusal")"
  echo "downgrade: $(cat "$folder/refusal")"
fi
if dyncal other report "$folder"/runs/mixed/since* --no-pdf >"$folder/log" 2>&1; then
  echo "downgrade: a report of a newer run is made"
else
  grep -q "use the dyncal that wrote it" "$folder/log" || fail "no sentence: $(cat "$folder/log")"
  echo "downgrade: $(tail -n 1 "$folder/log")"
fi

python3 - "$folder/runs/dyncal.sqlite" <<'PYTHON'
import sqlite3, sys
with sqlite3.connect(sys.argv[1]) as store:
    store.execute("INSERT INTO store_version SELECT MAX(version) + 1 FROM store_version")
PYTHON
for side in this other; do
  ! history "$side" "$folder/raised" || fail "$side opens a store that is newer than it"
  grep -q "newer dyncal" "$folder/refusal" || fail "no sentence: $(cat "$folder/refusal")"
done
echo "a store of a version that is not known yet: $(sed "s|$folder/||" "$folder/refusal")"
