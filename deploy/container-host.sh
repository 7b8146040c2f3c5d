#!/usr/bin/env bash
# What the container of Containerfile runs: analysis, recorder and page, until one of them or the
# container ends; then all end, with the exit status of the first.
set -uo pipefail
folder=/var/lib/dyncal
mkdir -p "$folder/recordings" "$folder/runs"

# shellcheck disable=SC2086 # options are words
{
  dyncal-analysis ${DYNCAL_OPTIONS:-} &
  dyncal-recorder --runs-only --folder "$folder/recordings" ${DYNCAL_OPTIONS:-} &
  dyncal-web --runs "$folder/runs" ${DYNCAL_OPTIONS:-} &
}
trap 'kill $(jobs -p) 2>/dev/null' TERM INT
wait -n
status=$?
kill $(jobs -p) 2>/dev/null
wait
[[ $status -ne 143 ]] || status=0 # ended by the signal of the container
exit "$status"
