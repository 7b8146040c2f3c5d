// Which frames a source delivers: a pattern of id bits, as the kernel's CAN sockets filter them.
// Plain data; any thread.
#pragma once

#include <cstdint>

#include "drivers/can/bus/can_frame.hpp"

namespace dyncal::drivers::can {

// Lets a frame through when (id ^ frame's id) & mask is 0; both without flag bits. Frames of the
// other id length never match.
struct FrameFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0;
  bool extended = false;

  [[nodiscard]] bool passes(const CanFrame& frame) const {
    return frame.extended == extended && ((frame.id ^ id) & mask) == 0;
  }
  friend bool operator==(const FrameFilter&, const FrameFilter&) = default;
};

} // namespace dyncal::drivers::can
