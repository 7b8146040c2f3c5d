// One CAN frame as it was received, with the stamps that came with it. Plain data; any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dyncal::drivers::can {

struct CanFrame {
  std::uint32_t id = 0; // 11 or 29 bits, without flags
  bool extended = false;
  bool remote = false;
  bool fd = false;              // CAN FD format
  bool bit_rate_switch = false; // FD: the data phase runs at the data bit rate
  bool error_state_indicator = false;
  bool sent_here = false;  // the echo of a frame that a program on this host has sent
  std::uint8_t length = 0; // bytes of data
  std::array<std::uint8_t, 64> data{};
  std::int64_t kernel_ns = 0;   // system clock when the kernel got the frame; 0: none
  std::int64_t hardware_ns = 0; // clock of the adapter, own epoch and rate; 0: none

  [[nodiscard]] std::span<const std::uint8_t> payload() const {
    return std::span(data).first(length);
  }
};

} // namespace dyncal::drivers::can
