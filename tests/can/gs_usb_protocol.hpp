// What a USB adapter of the gs_usb family says to the kernel's driver
// (drivers/net/can/usb/gs_usb.c; candleLight firmware): control requests, and one frame a bulk
// transfer, little-endian, with the adapter's stamp behind the space for the longest data of the
// format.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <linux/can.h>

#include "drivers/can/bus/can_frame.hpp"

namespace dyncal::tests::gs_usb {

enum class Request : std::uint8_t {
  host_format = 0,
  bit_timing = 1,
  mode = 2,
  bit_timing_limits = 4,
  device_config = 5,
  timestamp = 6,
  data_bit_timing = 10,
  extended_bit_timing_limits = 11
};

constexpr std::uint32_t mode_start = 1;
constexpr std::uint32_t mode_fd = 1U << 8U;

constexpr std::uint32_t feature_hardware_stamps = 1U << 4U;
constexpr std::uint32_t feature_fd = 1U << 8U;
constexpr std::uint32_t feature_extended_limits = 1U << 10U;

constexpr std::uint8_t flag_overflow = 1;
constexpr std::uint8_t flag_fd = 2;
constexpr std::uint8_t flag_bit_rate_switch = 4;
constexpr std::uint8_t flag_error_state = 8;

constexpr std::uint32_t not_an_echo = 0xFFFFFFFF;
constexpr std::uint32_t controller_clock_hz = 80'000'000;

struct HostFrame {
  std::uint32_t echo = not_an_echo; // the number that the host has given a frame of its own
  std::uint8_t channel = 0;
  bool overflow = false;   // frames before this one were lost in the adapter
  std::uint32_t error = 0; // classes, when this is an error frame
  std::uint32_t stamp_us = 0;
  drivers::can::CanFrame frame;
};

inline constexpr std::array<std::uint8_t, 16> fd_lengths = {0, 1,  2,  3,  4,  5,  6,  7,
                                                            8, 12, 16, 20, 24, 32, 48, 64};
inline constexpr std::size_t header_bytes = 12;

inline void put_32(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8) {
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

inline std::uint32_t get_32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] | std::uint32_t{bytes[at + 1]} << 8U | std::uint32_t{bytes[at + 2]} << 16U |
         std::uint32_t{bytes[at + 3]} << 24U;
}

// `stamped`: by an adapter that stamps.
inline std::vector<std::uint8_t> pack(const HostFrame& said, bool stamped) {
  const drivers::can::CanFrame& frame = said.frame;
  std::vector<std::uint8_t> bytes;
  put_32(bytes, said.echo);
  put_32(bytes, said.error != 0 ? CAN_ERR_FLAG | said.error
                                : frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) |
                                      (frame.remote ? CAN_RTR_FLAG : 0U));
  const auto code = std::lower_bound(fd_lengths.begin(), fd_lengths.end(), frame.length);
  bytes.push_back(static_cast<std::uint8_t>(code - fd_lengths.begin()));
  bytes.push_back(said.channel);
  bytes.push_back(static_cast<std::uint8_t>((said.overflow ? flag_overflow : 0) |
                                            (frame.fd ? flag_fd : 0) |
                                            (frame.bit_rate_switch ? flag_bit_rate_switch : 0) |
                                            (frame.error_state_indicator ? flag_error_state : 0)));
  bytes.push_back(0);
  bytes.insert(bytes.end(), frame.data.begin(),
               frame.data.begin() + (frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN));
  if (stamped) {
    put_32(bytes, said.stamp_us);
  }
  return bytes;
}

// Nothing where the host has said less than a frame.
inline std::optional<HostFrame> unpack(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < header_bytes) {
    return std::nullopt;
  }
  HostFrame said;
  said.echo = get_32(bytes, 0);
  const std::uint32_t id = get_32(bytes, 4);
  const std::uint8_t flags = bytes[10];
  said.channel = bytes[9];
  drivers::can::CanFrame& frame = said.frame;
  frame.extended = (id & CAN_EFF_FLAG) != 0;
  frame.remote = (id & CAN_RTR_FLAG) != 0;
  frame.id = id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.fd = (flags & flag_fd) != 0;
  frame.bit_rate_switch = (flags & flag_bit_rate_switch) != 0;
  frame.error_state_indicator = (flags & flag_error_state) != 0;
  frame.length = fd_lengths[bytes[8] & 15U];
  if (!frame.fd) {
    frame.length = std::min<std::uint8_t>(frame.length, CAN_MAX_DLEN);
  }
  if (bytes.size() < header_bytes + frame.length) {
    return std::nullopt;
  }
  std::copy_n(bytes.begin() + header_bytes, frame.length, frame.data.begin());
  return said;
}

} // namespace dyncal::tests::gs_usb
