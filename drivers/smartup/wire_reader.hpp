// Reads the primitives of Protocol Buffers (https://protobuf.dev/programming-guides/encoding) from
// bytes that nobody vouches for. Every read checks what is left and returns false at the first
// thing that cannot be, and then has not moved. A view: the bytes outlive the reader. One thread at
// a time.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace dyncal::drivers::smartup {

enum class WireType : std::uint8_t { varint = 0, fixed64 = 1, bytes = 2, fixed32 = 5 };

class WireReader {
public:
  explicit WireReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool at_end() const { return position_ == bytes_.size(); }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - position_; }

  // At most ten bytes; bits beyond the 64th are lost, as the format says.
  bool varint(std::uint64_t& value) {
    if (position_ < bytes_.size() && (bytes_[position_] & 0x80U) == 0) {
      value = bytes_[position_++]; // most tags and lengths
      return true;
    }
    std::uint64_t result = 0;
    for (std::size_t i = 0; i < max_varint && position_ + i < bytes_.size(); ++i) {
      const std::uint8_t byte = bytes_[position_ + i];
      result |= static_cast<std::uint64_t>(byte & 0x7FU) << (7 * i);
      if ((byte & 0x80U) == 0) {
        value = result;
        position_ += i + 1;
        return true;
      }
    }
    return false;
  }

  bool fixed32(std::uint32_t& value) {
    static_assert(std::endian::native == std::endian::little, "the wire is little-endian");
    if (left() < sizeof value) {
      return false;
    }
    std::memcpy(&value, bytes_.data() + position_, sizeof value);
    position_ += sizeof value;
    return true;
  }

  bool bytes(std::uint64_t count, std::span<const std::uint8_t>& value) {
    if (count > left()) {
      return false;
    }
    value = bytes_.subspan(position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::size_t>(count);
    return true;
  }

  bool delimited(std::span<const std::uint8_t>& value) {
    const std::size_t before = position_;
    std::uint64_t count = 0;
    if (varint(count) && bytes(count, value)) {
      return true;
    }
    position_ = before;
    return false;
  }

  // A field that is of no interest. False as well for groups, which proto2 messages of the unit do
  // not have.
  bool skip(WireType type) {
    std::uint64_t number = 0;
    std::span<const std::uint8_t> ignored;
    switch (type) {
    case WireType::varint:
      return varint(number);
    case WireType::fixed64:
      return bytes(8, ignored);
    case WireType::bytes:
      return delimited(ignored);
    case WireType::fixed32:
      return bytes(4, ignored);
    }
    return false;
  }

private:
  static constexpr std::size_t max_varint = 10;

  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
};

} // namespace dyncal::drivers::smartup
