# Two network namespaces, $writing and $reading, joined by a link that loses packets; to be sourced.
# Needs root, ip and nft; otherwise the test ends with 77 (skipped) and one line. Nothing is left
# behind.
#
#   make_lossy_link LOSS_PERCENT SUBJECT    SUBJECT: what is not tested when it is skipped
#
# Sets ${address[0]} (writing), ${address[1]} (reading) and $folder, removed at the end.
skip() {
  echo "SKIPPED: $subject is not tested: $1"
  exit 77
}

cleanup() {
  for namespace in "$writing" "$reading"; do
    ip netns pids "$namespace" 2>/dev/null | xargs -r kill -9 2>/dev/null || true
    ip netns delete "$namespace" 2>/dev/null || true
  done
  rm -rf "$folder"
}

make_lossy_link() {
  local loss_percent=$1
  subject=$2
  [[ $(id -u) == 0 ]] || skip "it needs root"
  for tool in ip nft; do command -v "$tool" >/dev/null || skip "there is no command $tool"; done
  writing=dyncal-w-$$
  reading=dyncal-r-$$
  folder=$(mktemp -d)
  trap cleanup EXIT
  ip netns add "$writing" 2>/dev/null && ip netns add "$reading" 2>/dev/null ||
    skip "this machine makes no network namespaces"
  # The interfaces are made inside the namespaces: they go with them.
  ip -n "$writing" link add lab type veth peer name lab netns "$reading" ||
    skip "this machine makes no veth interfaces"
  address=(10.97.0.1 10.97.0.2)
  local i namespace
  for i in 0 1; do
    namespace=$([[ $i == 0 ]] && echo "$writing" || echo "$reading")
    ip -n "$namespace" link set lo up
    ip -n "$namespace" address add "${address[$i]}/24" dev lab
    ip -n "$namespace" link set lab up
    if ((loss_percent > 0)); then
      ip netns exec "$namespace" nft "table ip lossy { chain input {
        type filter hook input priority 0;
        iifname lab meta l4proto udp numgen random mod 100 < $loss_percent counter drop
        }; }" || skip "nft cannot drop packets here"
    fi
  done
  # A participant uses the interfaces that are up when it is made.
  for namespace in "$writing" "$reading"; do
    for ((i = 0; i < 1200; i++)); do
      ip -n "$namespace" -br link show lab | grep -q LOWER_UP && break
      sleep 0.05
    done
  done
}

# Fails when a link that is to lose packets has lost none.
report_lost_packets() {
  local dropped
  dropped=$(ip netns exec "$reading" nft list table ip lossy |
    sed -n 's/.*counter packets \([0-9]*\).*/\1/p')
  echo "$dropped packets to the readers were lost on the way"
  ((dropped > 0))
}
