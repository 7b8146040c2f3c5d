#!/usr/bin/env bash
# The bus between two network namespaces, in every pair of vendors: 2000 blocks of 40 kB at 400 a
# second from two sources, to a reader that is there from the beginning, one that joins late, and
# one that is killed in the middle and started again. Each must have every block in order. Nothing
# depends on how long a program takes to start: the reader is killed when it has begun to read, and
# the second half is written when both later readers are there.
#
#   bus_netns_test.sh PEER multicast|unicast LOSS_PERCENT [VENDOR...]
#
# Needs root, ip and nft; exits with 77 (skipped) and one line otherwise. Leaves no namespace
# behind.
set -euo pipefail

peer=$1
discovery=$2
loss_percent=$3
shift 3
vendors=("${@:-fastdds cyclonedds}")
read -ra vendors <<<"${vendors[*]}"

. "$(dirname "${BASH_SOURCE[0]}")/lossy_link.sh"
make_lossy_link "$loss_percent" "the bus between network namespaces"

options=(--domain 44)
[[ $discovery == unicast ]] &&
  options+=(--unicast --peer "${address[0]}" --peer "${address[1]}" --interface lab)
write() {
  ip netns exec "$writing" "$peer" write --dds "$1" "${options[@]}" --readers 2 \
    --readers-at-half 3 >"$folder/writer" &
}
read_as() { # vendor, name, options
  ip netns exec "$reading" "$peer" read --dds "$1" "${options[@]}" "${@:3}" >"$folder/$2" &
}

patience_s=240
failed=0
check() { # name, process
  if wait "$2"; then echo "  $1: $(tail -n 1 "$folder/$1")"; else
    echo "  $1: FAILED: $(tail -n 1 "$folder/$1")"
    failed=1
  fi
}
end_of_writing() { # seconds
  for ((i = 0; i < $1 * 10; i++)); do
    [[ -s $folder/writer ]] && return
    sleep 0.1
  done
}

for from in "${vendors[@]}"; do
  for to in "${vendors[@]}"; do
    echo "$from to $to, $discovery, $loss_percent % of the packets lost"
    rm -f "$folder"/*
    read_as "$to" whole; whole=$!
    mkfifo "$folder/killed"
    read_as "$to" killed --until-killed; killed=$!
    write "$from"; writer=$!
    if ! read -r -t "$patience_s" <"$folder/killed"; then
      echo "  killed: FAILED: has not begun to read within $patience_s s"
      failed=1
    fi
    kill -9 "$killed" # ip has become the reader: it replaces itself
    wait "$killed" 2>/dev/null || true
    read_as "$to" late; late=$!
    read_as "$to" again; again=$!
    check whole "$whole"
    check late "$late"
    check again "$again"
    end_of_writing "$patience_s"
    kill "$writer" 2>/dev/null || true
    check writer "$writer"
  done
done
if ((loss_percent > 0)); then
  report_lost_packets || failed=1
fi
exit "$failed"
