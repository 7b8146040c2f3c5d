// Where frames come from: a CAN interface of the kernel, a recorded log, or a script of a test.
//
// Frames, losses, bus errors and changes of the link come as one stream, in the order in which they
// happened as far as the source knows it.
//
// open() once, then read() from one thread; stop() from any thread, at any time.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "drivers/can/bus/can_frame.hpp"
#include "drivers/can/bus/frame_filter.hpp"
#include "drivers/error.hpp"
#include "drivers/link/stop_signal.hpp"

namespace dyncal::drivers::can {

enum class BusState {
  unknown,
  error_active,
  error_warning,
  error_passive,
  bus_off,
  stopped,
  sleeping
};

[[nodiscard]] const char* to_string(BusState state);

struct LinkState {
  std::string name; // of the interface now: it may have been renamed
  bool present = false;
  bool up = false;
  bool carrier = false;
  BusState bus = BusState::unknown;
  std::optional<std::uint16_t> transmit_errors; // the controller's counters
  std::optional<std::uint16_t> receive_errors;
  std::uint32_t restarts = 0;       // of the controller since the kernel started
  std::uint32_t bit_rate_per_s = 0; // 0: the interface has none (virtual) or does not say
  std::uint32_t data_bit_rate_per_s = 0;
  double sample_point = 0.0;
  bool fd = false;
  bool listen_only = false;
  std::string kind;       // of the driver's link: "can", "vcan", "vxcan" ...
  std::string device_bus; // on which its controller is: "usb", "pci", "spi" ...; "" where it has
                          // none or the kernel does not say

  friend bool operator==(const LinkState&, const LinkState&) = default;
};

// Frames that the source knows to be lost since the last event of this kind.
struct FramesLost {
  std::uint64_t frames = 0;
};

struct BusFault {
  std::string
      cause; // in words: "stuff error", "no acknowledgment", "bus-off", "controller overrun" ...
  BusState state = BusState::unknown; // unknown: unchanged
  std::optional<std::uint16_t> transmit_errors;
  std::optional<std::uint16_t> receive_errors;
  bool frames_lost = false; // the controller had no room: an unknown number of frames is lost
};

struct LinkChange {
  LinkState link;
  bool interrupted = false; // frames may have been missed since the last frame
  std::string what;         // in words
};

using BusEvent = std::variant<CanFrame, FramesLost, BusFault, LinkChange>;

enum class ReadState { more, stopped, ended };

class FrameSource {
public:
  virtual ~FrameSource() = default;
  // Frames that pass none of the filters are not delivered. Fails with what the user can do about
  // it.
  [[nodiscard]] virtual Expected<LinkState> open(const std::vector<FrameFilter>& filters) = 0;
  // Waits for events up to `limit` and appends what there is.
  [[nodiscard]] virtual Expected<ReadState> read(std::vector<BusEvent>& events,
                                                 std::chrono::milliseconds limit) = 0;

  // Ends the read that waits and every later one with ReadState::stopped. From any thread.
  void stop() { stop_.raise(); }

protected:
  StopSignal stop_;
};

} // namespace dyncal::drivers::can
