#include "services/bus/fastdds/screen/message_check.hpp"

#include <algorithm>

namespace dyncal::bus {

using namespace rtps_format;

bool MessageCheck::accepts(Bytes datagram, Instant now) {
  forget_the_gone(now);
  if (datagram.size() < header_bytes || std::memcmp(datagram.data(), "RTPS", 4) != 0) {
    return true;
  }
  PlausibleNumbers::Way way;
  std::ranges::copy(datagram.subspan(header_bytes - prefix_bytes, prefix_bytes), way.from.begin());
  bool accepted = true;
  // To the end: a heartbeat says which numbers are plausible from now on.
  visit_submessages(datagram, [&](const Submessage& one) {
    if (one.id == info_source && one.body.size() >= header_bytes) {
      std::ranges::copy(one.body.last(prefix_bytes), way.from.begin());
    } else if (one.id == info_destination && one.body.size() >= prefix_bytes) {
      std::ranges::copy(one.body.first(prefix_bytes), way.to.begin());
    }
    accepted = numbers_.accepts(way, one.id, one.flags, one.body) &&
               (one.id != data || announcements_.accepts(way.from, one.flags, one.body, now)) &&
               accepted;
    return true;
  });
  return accepted;
}

void MessageCheck::forget_the_gone(Instant now) {
  const auto time = now.time_since_epoch().count();
  auto due = next_forgetting_.load();
  const auto next = time + Instant::duration(forget_interval).count();
  if (time < due || !next_forgetting_.compare_exchange_strong(due, next)) {
    return; // another thread does it
  }
  if (const auto gone = announcements_.forget_the_gone(now); !gone.empty()) {
    numbers_.forget(gone);
  }
}

} // namespace dyncal::bus
