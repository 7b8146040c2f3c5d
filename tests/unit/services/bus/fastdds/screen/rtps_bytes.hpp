// RTPS messages as tests make them, little-endian. Plain functions; any thread.
#pragma once

#include <cstdint>
#include <vector>

namespace dyncal::bus::tests_of_rtps {

using Bytes = std::vector<unsigned char>;

inline Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

inline Bytes u16(unsigned value) {
  return {static_cast<unsigned char>(value), static_cast<unsigned char>(value >> 8U)};
}

inline Bytes u32(std::uint32_t value) {
  return u16(value & 0xffffU) + u16(value >> 16U);
}

inline Bytes sequence(std::uint64_t value) {
  return u32(static_cast<std::uint32_t>(value >> 32U)) + u32(static_cast<std::uint32_t>(value));
}

inline Bytes submessage(unsigned char id, unsigned char flags, const Bytes& body) {
  return Bytes{id, flags} + u16(static_cast<unsigned>(body.size())) + body;
}

inline const Bytes participant{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};

inline Bytes header(const Bytes& from = participant) {
  return Bytes{'R', 'T', 'P', 'S', 2, 1, 1, 16} + from;
}

} // namespace dyncal::bus::tests_of_rtps
