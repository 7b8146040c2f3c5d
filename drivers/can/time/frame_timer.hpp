// When a frame began on the bus, on the host's clock.
//
//   start = kernel stamp - latency - duration
//
// The kernel's stamp is taken after the end of the frame; the duration is counted from the frame's
// own bits. The adapter's stamp marks the start or the end of the frame (settings) on a clock of
// its own, which ClockLine relates to the kernel's stamps; both are moved to the start of the frame
// before they are compared, so that stuffing does not tilt the line.
//
// The first frame decides which of the two is used: the adapter's stamp where it has one and the
// settings allow it. One thread.
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/can/bus/bit_rates.hpp"
#include "drivers/can/bus/can_frame.hpp"
#include "drivers/can/bus/frame_source.hpp"
#include "drivers/can/time/clock_line.hpp"
#include "drivers/can/time/stamp_point.hpp"

namespace dyncal::drivers::can {

struct FrameTimerSettings {
  BitRates bit_rates;
  bool use_hardware_stamps = true; // where the adapter has them
  StampPoint hardware_stamp_point = StampPoint::unknown;
  double hardware_tick_s = 1e-6;
  bool correct_frame_duration = true; // off only to show what it is worth
  // From the stamped instant to the stamp, the smallest of the delays; and its standard
  // uncertainty, by default that of the kind of adapter.
  double latency_s = 0.0;
  std::optional<double> u_latency_s;
};

class FrameTimer {
public:
  // REQUIRES: settings.bit_rates.nominal_per_s > 0 when the frame duration is corrected.
  FrameTimer(const FrameTimerSettings& settings, const LinkState& link);

  // Every frame, in the order received. False when a clock was set: what was said before is no
  // longer comparable.
  bool add(const CanFrame& frame);
  // The adapter's clock has restarted.
  void restart();

  [[nodiscard]] bool uses_hardware() const { return uses_hardware_.value_or(false); }
  // Nothing while the line to the adapter's clock has not settled.
  [[nodiscard]] std::optional<std::int64_t> start_of_frame_ns(const CanFrame& frame) const;
  [[nodiscard]] std::optional<std::int64_t> end_of_frame_ns(const CanFrame& frame) const;
  // The best that can be said at once, for when waiting has no end: from the kernel's stamp.
  [[nodiscard]] std::int64_t kernel_start_of_frame_ns(const CanFrame& frame) const;

  // Standard uncertainties: what is common to all stamps; and of the line now (0 without one).
  [[nodiscard]] double u_common_s() const;
  [[nodiscard]] double u_line_s() const { return uses_hardware() ? hardware_line_.u_s() : 0.0; }
  [[nodiscard]] std::uint64_t clock_restarts() const { return hardware_line_.restarts(); }

private:
  [[nodiscard]] std::int64_t duration_ns(const CanFrame& frame) const;
  [[nodiscard]] std::int64_t hardware_start_ns(const CanFrame& frame) const;

  FrameTimerSettings settings_;
  bool remote_adapter_; // behind USB or a serial line
  std::optional<bool> uses_hardware_;
  ClockLine hardware_line_;
  double max_duration_s_ = 0.0; // of the frames seen
};

} // namespace dyncal::drivers::can
