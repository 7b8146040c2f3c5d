#include "drivers/can/time/frame_duration.hpp"

#include <algorithm>
#include <array>

namespace dyncal::drivers::can {

namespace {

constexpr unsigned same_bits_before_stuffing = 5;

// Follows the bits of a frame as they go over the bus: counts the stuff bits and forms the classic
// checksum.
class BitStream {
public:
  void put(bool bit) {
    if (stuff_due_) { // what would have followed a fifth equal bit comes behind a stuff bit
      ++count_;
      ++stuff_;
      last_ = !last_;
      run_ = 1;
      stuff_due_ = false;
    }
    const bool feedback = bit != ((crc15_ >> 14U & 1U) != 0);
    crc15_ = (crc15_ << 1U) & 0x7FFFU;
    if (feedback) {
      crc15_ ^= 0x4599U;
    }
    ++count_;
    run_ = count_ > 1 && bit == last_ ? run_ + 1 : 1;
    last_ = bit;
    stuff_due_ = run_ == same_bits_before_stuffing;
  }
  void put(std::uint32_t value, unsigned bits) {
    while (bits > 0) {
      put((value >> --bits & 1U) != 0);
    }
  }
  // The stuff bit behind the last bit, which classic frames have and FD frames do not: there a
  // fixed stuff bit stands in its place.
  void finish() {
    if (stuff_due_) {
      ++count_;
      ++stuff_;
      stuff_due_ = false;
    }
  }

  [[nodiscard]] std::uint32_t crc15() const { return crc15_; }
  [[nodiscard]] unsigned count() const { return count_; }
  [[nodiscard]] unsigned stuff() const { return stuff_; }

private:
  std::uint32_t crc15_ = 0;
  unsigned count_ = 0;
  unsigned stuff_ = 0;
  unsigned run_ = 0;
  bool last_ = true;
  bool stuff_due_ = false;
};

constexpr std::array<unsigned, 16> fd_lengths = {0, 1,  2,  3,  4,  5,  6,  7,
                                                 8, 12, 16, 20, 24, 32, 48, 64};

std::uint32_t fd_dlc(unsigned length_bytes) {
  return static_cast<std::uint32_t>(
      std::lower_bound(fd_lengths.begin(), fd_lengths.end(), std::min(length_bytes, 64U)) -
      fd_lengths.begin());
}

// SOF, identifier and the bits up to IDE (base) or RTR/RRS (extended).
void put_identifier(BitStream& stream, const CanFrame& frame, bool remote) {
  stream.put(false);
  if (frame.extended) {
    stream.put(frame.id >> 18U, 11);
    stream.put(0b11, 2); // SRR, IDE
    stream.put(frame.id & 0x3FFFFU, 18);
    stream.put(remote);
  } else {
    stream.put(frame.id, 11);
    stream.put(remote);
    stream.put(false); // IDE
  }
}

FrameBits classic_bits(const CanFrame& frame) {
  BitStream stream;
  put_identifier(stream, frame, frame.remote);
  stream.put(0, frame.extended ? 2 : 1); // reserved
  const unsigned length = std::min<unsigned>(frame.length, 8);
  stream.put(length, 4);
  for (unsigned i = 0; !frame.remote && i < length; ++i) {
    stream.put(frame.data[i], 8);
  }
  const std::uint32_t crc = stream.crc15();
  stream.put(crc, 15);
  stream.finish();
  constexpr unsigned behind = 1 + 2 + 7; // CRC delimiter, ACK and its delimiter, end of frame
  return {stream.count() + behind, 0, stream.stuff()};
}

FrameBits fd_bits(const CanFrame& frame) {
  BitStream stream;
  put_identifier(stream, frame, false);
  stream.put(0b10, 2); // FDF, reserved
  stream.put(frame.bit_rate_switch);
  const unsigned arbitration = stream.count();
  stream.put(frame.error_state_indicator);
  const std::uint32_t dlc = fd_dlc(frame.length);
  stream.put(dlc, 4);
  const unsigned length = fd_lengths[dlc];
  for (unsigned i = 0; i < length; ++i) {
    stream.put(frame.data[i], 8);
  }
  const unsigned crc = length > 16 ? 21 : 17;
  const unsigned fixed_stuff =
      length > 16
          ? 7
          : 6; // before the stuff count and behind every fourth bit of it and of the checksum
  const unsigned data_phase =
      stream.count() - arbitration + 4 + crc + fixed_stuff + 1; // stuff count, CRC, CRC delimiter
  constexpr unsigned behind = 2 + 7;
  FrameBits bits{arbitration + behind, data_phase, stream.stuff() + fixed_stuff};
  if (!frame.bit_rate_switch) {
    bits.nominal += bits.data;
    bits.data = 0;
  }
  return bits;
}

} // namespace

FrameBits frame_bits(const CanFrame& frame) {
  return frame.fd ? fd_bits(frame) : classic_bits(frame);
}

double frame_duration_s(const CanFrame& frame, const BitRates& rates) {
  const FrameBits bits = frame_bits(frame);
  return bits.nominal / rates.nominal_per_s + (bits.data > 0 ? bits.data / rates.data_per_s : 0.0);
}

double max_frame_s(bool fd, bool bit_rate_switch, unsigned length_bytes, const BitRates& rates) {
  if (!fd) { // extended id; every fifth bit from SOF to the checksum may bring a stuff bit, which
             // counts for the next five
    const unsigned stuffed = 54 + 8 * std::min(length_bytes, 8U);
    const unsigned max_stuff_bits = (stuffed - 1) / 4;
    return (stuffed + max_stuff_bits + 10) / rates.nominal_per_s;
  }
  const unsigned length = fd_lengths[fd_dlc(length_bytes)];
  const unsigned data_field = 5 + 8 * length;
  const double data_rate = bit_rate_switch ? rates.data_per_s : rates.nominal_per_s;
  const unsigned arbitration = 36;
  return (arbitration + (arbitration - 1) / 4 + 9) / rates.nominal_per_s +
         (data_field + data_field / 4 + 4 + (length > 16 ? 21 + 7 : 17 + 6) + 1) / data_rate;
}

} // namespace dyncal::drivers::can
