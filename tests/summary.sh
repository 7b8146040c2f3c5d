#!/usr/bin/env bash
# Sums up a run of ctest, with the reason of every test that was skipped and the last lines of what
# each failed test printed:
#
#   tests/summary.sh OUTPUT_OF_CTEST LastTest.log
#
# A reason is what GoogleTest prints after "Skipped", or a line of the test's output that begins
# with "skipped:".
set -euo pipefail

awk -v shown=30 '
  # Output of ctest: how many ran, which ones failed or were skipped.
  FNR == NR && /tests passed,.* tests failed out of / { failed = $(NF - 5); total = $NF }
  FNR == NR && /^\t *[0-9]+ - .* \([A-Za-z ]+\)$/ {
    sub(/^\t *[0-9]+ - /, "")
    if (sub(/ \(Skipped\)$/, "")) skipped[++skips] = $0
    else if (sub(/ \([A-Za-z ]+\)$/, "")) has_failed[$0]
  }
  FNR == NR { next }
  # The log: the output of every test.
  /^[0-9]+\/[0-9]+ Test: / {
    name = $0
    sub(/^[0-9]+\/[0-9]+ Test: /, "", name)
    next_is_reason = 0
    lines = 0
  }
  { line[++lines % shown] = $0 }
  /^<end of output>$/ && name in has_failed {
    ends = ends "\nFailed: " name ", the end of its output:\n"
    for (i = lines < shown ? 1 : lines - shown + 1; i < lines; ++i)
      ends = ends "  " line[i % shown] "\n"
  }
  next_is_reason { reason[name] = $0; next_is_reason = 0 }
  /: Skipped$/ { next_is_reason = 1 }
  tolower($0) ~ /^skipped: / && !(name in reason) { reason[name] = substr($0, 10) }
  END {
    if (skips) print "\nSkipped:"
    for (i = 1; i <= skips; ++i)
      print "  " skipped[i] ": " (skipped[i] in reason ? reason[skipped[i]] : "gives no reason")
    printf "%s", ends
    printf "\n%d passed, %d failed, %d skipped\n", total - failed - skips, failed, skips
  }
' "$1" "$2"
