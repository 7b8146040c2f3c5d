#!/usr/bin/env bash
# A source whose writer waits for no reader, in every pair of vendors: beside a reader that keeps up
# is one that hangs (it is alive and takes nothing). The first must have every block in order, and
# no write may take long: 4000 blocks of 40 kB at 200 a second, more than the hanging one holds.
#
#   hanging_reader_test.sh PEER [VENDOR...]      DYNCAL_DOMAIN: default 45
set -euo pipefail

peer=$1
shift 1
vendors=("${@:-fastdds cyclonedds}")
read -ra vendors <<<"${vendors[*]}"
folder=$(mktemp -d)
started=()
cleanup() {
  ((${#started[@]} == 0)) || kill -9 "${started[@]}" 2>/dev/null || true
  rm -rf "$folder"
}
trap cleanup EXIT
options=(--domain "${DYNCAL_DOMAIN:-45}" --blocks 4000 --rate 200)
patience_s=240
failed=0

for from in "${vendors[@]}"; do
  for to in "${vendors[@]}"; do
    rm -f "$folder"/*
    mkfifo "$folder/hanging"
    "$peer" read --dds "$to" "${options[@]}" --hang >"$folder/hanging" & hanging=$!
    "$peer" read --dds "$to" "${options[@]}" >"$folder/reader" & reader=$!
    "$peer" write --live --dds "$from" "${options[@]}" --readers 2 >"$folder/writer" & writer=$!
    started=("$hanging" "$reader" "$writer")
    read -r -t "$patience_s" <"$folder/hanging" || failed=1
    wait "$reader" || failed=1
    kill "$writer"
    wait "$writer" || failed=1
    kill -9 "$hanging" 2>/dev/null || true
    wait "$hanging" 2>/dev/null || true
    started=()
    echo "$from to $to: $(tail -n 1 "$folder/reader"); $(tail -n 1 "$folder/writer")"
    longest=$(sed -n 's/.*longest write \([0-9.]*\) s.*/\1/p' "$folder/writer")
    awk -v longest="${longest:-99}" 'BEGIN { exit !(longest < 0.5) }' || {
      echo "  FAILED: a write waited for the reader that hangs"
      failed=1
    }
  done
done
exit "$failed"
