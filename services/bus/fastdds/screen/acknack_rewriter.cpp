#include "services/bus/fastdds/screen/acknack_rewriter.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace dyncal::bus {

using namespace rtps_format;

std::optional<std::size_t> AcknackRewriter::rewrite(Bytes source, unsigned char& flags,
                                                    std::span<unsigned char> body) {
  constexpr std::size_t bits_at = entities_bytes + sequence_bytes;
  const auto words = bitmap_words(body, bits_at, flags);
  const auto base = words ? sequence_at(body, entities_bytes, flags) : std::nullopt;
  if (!base || bits_at + 4 + 4 * *words + 4 > body.size()) {
    return std::nullopt;
  }
  const std::size_t count_at = bits_at + 4 + 4 * *words;
  const auto count = number_at<std::uint32_t>(body, count_at, flags);
  const bool begins_count = *base == 1 && count == 0 && (flags & final_flag) == 0;
  const AcknackCounts::Pair pair = AcknackCounts::pair(source, body.first(entities_bytes));
  const auto now = std::chrono::steady_clock::now();
  auto anew = begins_count ? counts_.begin_anew(pair, now) : std::nullopt;
  if (!anew) {
    const auto passed = counts_.continued(pair, {*base, *words > 0, count}, now);
    if (!passed.begins_anew) {
      put_number(&body[count_at], passed.count, flags);
      return body.size();
    }
    anew = passed.count;
  }
  // As of a reader in Fast DDS that has nothing and does not know of anything.
  flags &= little_endian_flag;
  std::ranges::fill(body.subspan(entities_bytes, sequence_bytes + 4), 0);
  put_number(&body[bits_at + 4], *anew, flags);
  return bits_at + 4 + 4;
}

void AcknackRewriter::rewrite_all(std::span<unsigned char> datagram) {
  if (datagram.size() < header_bytes || std::memcmp(datagram.data(), "RTPS", 4) != 0) {
    return;
  }
  const Bytes source = datagram.subspan(header_bytes - prefix_bytes, prefix_bytes);
  visit_submessages(datagram, [&](const Submessage& one) {
    if (one.id == acknack) {
      const auto at = static_cast<std::size_t>(one.body.data() - datagram.data());
      unsigned char& flags = datagram[at - submessage_header_bytes + 1];
      static_cast<void>(rewrite(source, flags, datagram.subspan(at, one.body.size())));
    }
    return true;
  });
}

} // namespace dyncal::bus
