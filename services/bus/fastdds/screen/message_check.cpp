#include "services/bus/fastdds/screen/message_check.hpp"

#include <algorithm>

#include "services/bus/fastdds/screen/security_tokens.hpp"

namespace dyncal::bus {

using namespace rtps_format;

namespace {

constexpr std::array<unsigned char, entity_bytes> announcement_writer{0x00, 0x01, 0x00, 0xc2};
constexpr std::array<unsigned char, entity_bytes> handshake_writer{0x00, 0x02, 0x01, 0xc3};

// What comes before anybody is trusted. Both vendors send it in one piece; pieces could not be
// looked at.
bool handshake_is_readable(const Submessage& one) {
  constexpr std::size_t writer_at = 8;
  if ((one.id != data && one.id != data_frag) || one.body.size() < writer_at + entity_bytes) {
    return true;
  }
  const Bytes writer = one.body.subspan(writer_at, entity_bytes);
  const bool is_handshake = std::ranges::equal(writer, handshake_writer);
  if (one.id == data_frag) {
    return !is_handshake && !std::ranges::equal(writer, announcement_writer);
  }
  const auto begin = qos_begin(one.body, data_bytes_before_qos, one.flags);
  const auto qos = begin ? inline_qos(one.body, *begin, one.flags) : std::nullopt;
  return !is_handshake || !qos || (one.flags & data_flag) == 0 ||
         handshake_is_whole(one.body.subspan(qos->end));
}

} // namespace

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
               handshake_is_readable(one) && accepted;
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
