#include "services/bus/rtps/message_check.hpp"

#include <algorithm>

namespace dyncal::bus {

using namespace rtps_format;

bool MessageCheck::accepts(Bytes datagram) {
  if (datagram.size() < header_bytes || std::memcmp(datagram.data(), "RTPS", 4) != 0) {
    return true;
  }
  PlausibleNumbers::Way way;
  std::ranges::copy(datagram.subspan(header_bytes - prefix_bytes, prefix_bytes), way.from.begin());
  bool accepted = true;
  // To the end: a heartbeat says which numbers are plausible from now on.
  for (std::size_t at = header_bytes; at + submessage_header_bytes <= datagram.size();) {
    const unsigned char id = datagram[at];
    const unsigned char flags = datagram[at + 1];
    std::size_t length = number_at<std::uint16_t>(datagram, at + 2, flags);
    at += submessage_header_bytes;
    if (length == 0 && id != info_timestamp && id != pad) {
      length = datagram.size() - at; // the last one
    }
    if (length > datagram.size() - at) {
      return accepted;
    }
    const Bytes body = datagram.subspan(at, length);
    if (id == info_source && body.size() >= header_bytes) {
      std::ranges::copy(body.last(prefix_bytes), way.from.begin());
    } else if (id == info_destination && body.size() >= prefix_bytes) {
      std::ranges::copy(body.first(prefix_bytes), way.to.begin());
    }
    accepted = numbers_.accepts(way, id, flags, body) &&
               (id != data || announcements_.accepts(way.from, flags, body)) && accepted;
    at += (length + 3U) & ~std::size_t{3};
  }
  return accepted;
}

} // namespace dyncal::bus
