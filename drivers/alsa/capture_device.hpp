// What a source asks of a sound device: to open it, to read frames, to begin again.
//
// Frames come in the order of their channels, little-endian. Instants are of the steady clock. One
// thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <string>

#include "drivers/error.hpp"

namespace dyncal::drivers::alsa {

using Instant = std::chrono::steady_clock::time_point;

enum class CaptureEvent {
  frames,  // of which there may be none
  overrun, // frames were lost; restart()
  gone,    // open() it again
  stopped
};

struct Captured {
  CaptureEvent event = CaptureEvent::frames;
  std::size_t frames = 0;
  std::size_t waiting = 0; // more that the device holds
  Instant at{};            // when it held these
  std::string problem{};   // of a device that is gone
};

class CaptureDevice {
public:
  virtual ~CaptureDevice() = default;
  // Opens and starts it, and gives when it started. Fails (not_found, refused, invalid_setting)
  // with a sentence that names the device.
  [[nodiscard]] virtual Expected<Instant> open() = 0;
  // After an overrun.
  [[nodiscard]] virtual Expected<Instant> restart() = 0;
  // Waits for frames, as many as there is room for. REQUIRES: it is open.
  [[nodiscard]] virtual Captured read(std::span<std::byte> room) = 0;
  // "" where it does not say.
  [[nodiscard]] virtual std::string name() const = 0;
};

} // namespace dyncal::drivers::alsa
