#!/usr/bin/env bash
# Results that are already there, to readers that come late over a link that loses packets, in every
# pair of vendors: 150 results of 3 kB each, so that each travels in fragments whose first may be
# the one that is lost. Every reader must have all of them; one that hangs in its vendor's code is
# killed and fails the test.
#
#   results_netns_test.sh PEER LOSS_PERCENT READERS [VENDOR...]
set -euo pipefail

peer=$1
loss_percent=$2
readers=$3
shift 3
vendors=("${@:-fastdds cyclonedds}")
read -ra vendors <<<"${vendors[*]}"

. "$(dirname "${BASH_SOURCE[0]}")/lossy_link.sh"
make_lossy_link "$loss_percent" "late readers of results over a lossy link"

patience_s=60
failed=0
for from in "${vendors[@]}"; do
  for to in "${vendors[@]}"; do
    ip netns exec "$writing" "$peer" write-results --dds "$from" --domain 45 &
    writer=$!
    complete=0
    for ((i = 0; i < readers; i++)); do
      if timeout -s KILL "$patience_s" ip netns exec "$reading" \
        "$peer" read-results --dds "$to" --domain 45 >"$folder/reader" 2>&1; then
        complete=$((complete + 1))
      else
        echo "  FAILED: $(tail -n 1 "$folder/reader" | cut -c -200)"
        failed=1
      fi
    done
    echo "$from to $to, $loss_percent % of the packets lost: $complete of $readers readers have" \
      "every result"
    kill "$writer"
    wait "$writer" 2>/dev/null || true
  done
done
report_lost_packets || failed=1
exit "$failed"
