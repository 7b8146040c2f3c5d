#include "services/bus/payload_checksum.hpp"

#include <cstring>

#include <zlib.h>

namespace dyncal::bus {

std::uint32_t payload_checksum(const char* bytes, std::size_t count) {
  const auto* data = reinterpret_cast<const Bytef*>(bytes); // NOLINT: zlib's bytes are unsigned
  const uLong sum = crc32_z(0, data, count);
  return sum == 0 ? 1 : static_cast<std::uint32_t>(sum);
}

bool ends_with_checksum(const char* payload, std::size_t count) {
  if (count < 2 * checksum_bytes) { // the header, and the checksum
    return false;
  }
  const std::uint32_t sum = payload_checksum(payload, count - checksum_bytes);
  const bool little_endian = (static_cast<unsigned char>(payload[1]) & 1U) != 0;
  for (std::size_t i = 0; i < checksum_bytes; ++i) {
    const std::size_t place = little_endian ? i : checksum_bytes - 1 - i;
    const auto given = static_cast<unsigned char>(payload[count - checksum_bytes + i]);
    if (given != ((sum >> (8 * place)) & 0xFFU)) {
      return false;
    }
  }
  return true;
}

void set_checksum(char* payload, std::size_t count) {
  const std::size_t at = count - checksum_bytes;
  const std::uint32_t sum = payload_checksum(payload, at);
  std::memcpy(payload + at, &sum, sizeof sum);
}

} // namespace dyncal::bus
