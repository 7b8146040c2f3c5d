// How an RTPS message is laid out: its header, the kinds of submessages, numbers and sets of
// numbers in either byte order.
//
// DDSI-RTPS 2.2, chapters 8.3 and 9.4. Positions count from the beginning of a submessage's body.
// Functions that read say so where the bytes must be there; none allocates. Any thread.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

namespace dyncal::bus::rtps_format {

using Bytes = std::span<const unsigned char>;

static_assert(std::endian::native == std::endian::little,
              "byte orders here are written for little-endian machines");

constexpr std::size_t header_bytes = 20;
constexpr std::size_t prefix_bytes = 12; // of a participant's GUID, the last ones of the header
constexpr std::size_t entity_bytes = 4;
constexpr std::size_t submessage_header_bytes = 4;
constexpr unsigned char protocol_major = 2;

constexpr unsigned char acknack = 0x06;
constexpr unsigned char heartbeat = 0x07;
constexpr unsigned char gap = 0x08;
constexpr unsigned char info_timestamp = 0x09;
constexpr unsigned char info_source = 0x0c;
constexpr unsigned char info_destination = 0x0e;
constexpr unsigned char nack_frag = 0x12;
constexpr unsigned char heartbeat_frag = 0x13;
constexpr unsigned char data = 0x15;
constexpr unsigned char data_frag = 0x16;
constexpr unsigned char pad = 0x01;

constexpr unsigned char little_endian_flag = 0x01;
constexpr unsigned char final_flag = 0x02; // of ACKNACK
constexpr unsigned char no_timestamp_flag = 0x02;
constexpr unsigned char inline_qos_flag = 0x02;
constexpr unsigned char data_flag = 0x04; // of DATA
constexpr unsigned char key_flag = 0x08;  // of DATA
constexpr unsigned char key_of_fragment_flag = 0x04;

constexpr std::size_t entities_bytes = 2 * entity_bytes; // reader and writer
constexpr std::size_t sequence_bytes = 8;
constexpr std::size_t data_bytes_before_qos = 20;
constexpr std::size_t fragment_bytes_before_qos = 32;

constexpr std::uint16_t pid_pad = 0x0000;
constexpr std::uint16_t pid_sentinel = 0x0001;
constexpr std::uint16_t pid_key_hash = 0x0070;
constexpr std::uint16_t pid_status_info = 0x0071;

constexpr std::uint32_t max_bits_of_set = 256;
constexpr std::int64_t max_sequence = std::int64_t{1} << 48;

using Prefix = std::array<unsigned char, prefix_bytes>;

// REQUIRES for this and sequence_at(): the bytes are there.
template <class Number>
[[nodiscard]] Number number_at(Bytes bytes, std::size_t at, unsigned char flags) {
  Number value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  if ((flags & little_endian_flag) != 0) {
    return value;
  }
  if constexpr (sizeof value == 2) {
    return static_cast<Number>(__builtin_bswap16(value));
  } else {
    return static_cast<Number>(__builtin_bswap32(value));
  }
}

struct Submessage {
  unsigned char id = 0;
  unsigned char flags = 0;
  Bytes body;
};

// Calls `visit` with each submessage behind the header until it returns false. Returns whether it
// was called with all: false too where one is longer than the datagram.
template <class Visit>
bool visit_submessages(Bytes datagram, Visit&& visit) {
  for (std::size_t at = header_bytes; at + submessage_header_bytes <= datagram.size();) {
    Submessage one{.id = datagram[at], .flags = datagram[at + 1], .body = {}};
    std::size_t length = number_at<std::uint16_t>(datagram, at + 2, one.flags);
    at += submessage_header_bytes;
    if (length == 0 && one.id != info_timestamp && one.id != pad) {
      length = datagram.size() - at; // the last one
    }
    if (length > datagram.size() - at) {
      return false;
    }
    one.body = datagram.subspan(at, length);
    if (!visit(one)) {
      return false;
    }
    at += (length + 3U) & ~std::size_t{3};
  }
  return true;
}

// Nothing where it is not one that a writer can have.
[[nodiscard]] std::optional<std::int64_t> sequence_at(Bytes bytes, std::size_t at,
                                                      unsigned char flags);

// Words of a bitmap behind its number of bits at `at`; nothing where they are not there.
[[nodiscard]] std::optional<std::size_t> bitmap_words(Bytes body, std::size_t at,
                                                      unsigned char flags);

struct InlineQos {
  std::size_t end = 0;                      // where the payload begins
  std::optional<std::size_t> key_hash = {}; // where the identifier of a key hash is
  bool ends_instance = false;               // it is disposed of, or its writer leaves it
};

// Nothing where the list does not end within the submessage.
[[nodiscard]] std::optional<InlineQos> inline_qos(Bytes body, std::size_t begin,
                                                  unsigned char flags);

// Where the inline QoS of DATA and DATA_FRAG begins; nothing where it is not within the submessage.
[[nodiscard]] std::optional<std::size_t> qos_begin(Bytes body, std::size_t at_least,
                                                   unsigned char flags);

} // namespace dyncal::bus::rtps_format
