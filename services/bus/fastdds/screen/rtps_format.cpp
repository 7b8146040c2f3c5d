#include "services/bus/fastdds/screen/rtps_format.hpp"

namespace dyncal::bus::rtps_format {

std::optional<std::int64_t> sequence_at(Bytes bytes, std::size_t at, unsigned char flags) {
  const auto high = static_cast<std::int32_t>(number_at<std::uint32_t>(bytes, at, flags));
  const std::int64_t low = number_at<std::uint32_t>(bytes, at + 4, flags);
  const std::int64_t sequence = std::int64_t{high} * (std::int64_t{1} << 32) + low;
  return sequence >= 0 && sequence < max_sequence ? std::optional(sequence) : std::nullopt;
}

std::optional<std::size_t> bitmap_words(Bytes body, std::size_t at, unsigned char flags) {
  if (at + 4 > body.size()) {
    return std::nullopt;
  }
  const auto bits = number_at<std::uint32_t>(body, at, flags);
  const std::size_t words = (std::size_t{bits} + 31) / 32;
  return bits <= max_bits_of_set && at + 4 + 4 * words <= body.size() ? std::optional(words)
                                                                      : std::nullopt;
}

std::optional<InlineQos> inline_qos(Bytes body, std::size_t begin, unsigned char flags) {
  InlineQos found{begin};
  if ((flags & inline_qos_flag) == 0) {
    return found;
  }
  for (std::size_t at = begin; at + 4 <= body.size();) {
    const auto id = number_at<std::uint16_t>(body, at, flags);
    const std::size_t length = number_at<std::uint16_t>(body, at + 2, flags);
    if (id == pid_sentinel) {
      found.end = at + 4;
      return found;
    }
    if (id == pid_key_hash) {
      found.key_hash = at;
    }
    constexpr std::size_t last_of_status = 7; // bits 0 and 1, in big endian whatever the flags
    if (id == pid_status_info && length >= 4 && at + last_of_status < body.size()) {
      found.ends_instance = (body[at + last_of_status] & 0x03U) != 0;
    }
    at += 4 + ((length + 3U) & ~std::size_t{3});
  }
  return std::nullopt;
}

std::optional<std::size_t> qos_begin(Bytes body, std::size_t at_least, unsigned char flags) {
  if (body.size() < at_least) {
    return std::nullopt;
  }
  const std::size_t begin = 4U + number_at<std::uint16_t>(body, 2, flags);
  return begin >= at_least && begin <= body.size() ? std::optional(begin) : std::nullopt;
}

} // namespace dyncal::bus::rtps_format
