#!/usr/bin/env bash
# Writes the manual pages of a program and of each of its commands, from their --help, by help2man:
#
#   write-man-pages.sh PROGRAM FOLDER
#
# PROGRAM.1 and PROGRAM-COMMAND.1 for all that `PROGRAM --print-commands` lists, in FOLDER, which is
# made anew.
set -euo pipefail
program=$1
folder=$2

rm -rf "$folder"
mkdir -p "$folder"
version=$("$program" --version | sed -n '1s/^[^ ]* \([^ ]*\).*/\1/p')
"$program" --print-commands | while IFS=$'\t' read -r command description; do
  page=${command// /-}
  words=${command#"$(basename "$program")"}
  help2man --no-info --version-string "$page $version" --name "$description" \
    --output "$folder/$page.1" "$program$words"
done
