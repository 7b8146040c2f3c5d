#!/usr/bin/env bash
# Runs a command twice; passes when both runs pass and say the same on their lines with WORD:
#
#   same_twice.sh WORD COMMAND ARGUMENTS...
#
# Exit status: the command's when that is not 0; 1 when the lines differ or there is none.
set -uo pipefail
word=$1
shift
first=$("$@") || { status=$?; echo "$first"; exit "$status"; }
second=$("$@") || { status=$?; echo "$second"; exit "$status"; }
echo "$first"
expected=$(grep -e "$word" <<<"$first") || { echo "same_twice: no line with '$word'"; exit 1; }
[[ $expected == "$(grep -e "$word" <<<"$second")" ]] && echo "the same twice" && exit 0
echo "$second"
echo "same_twice: the two runs differ"
exit 1
