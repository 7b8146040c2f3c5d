#include "drivers/can/time/frame_timer.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/can/time/frame_duration.hpp"

namespace dyncal::drivers::can {

namespace {

// Of the smallest delay between the end of a frame and the kernel's stamp, where nobody has
// measured it: interrupt and scheduling of the kernel for stamps that are taken as they are; the
// little that is left of it under a line that follows the earliest of many; and from an adapter on
// USB or on a serial line something between 0 and 300 us, whatever stamps it takes itself, as its
// clock is known through the kernel's stamps alone.
constexpr double u_kernel_latency_s = 60e-6;
constexpr double u_hardware_latency_s = 20e-6;
constexpr double max_usb_latency_s = 300e-6;

} // namespace

FrameTimer::FrameTimer(const FrameTimerSettings& settings, const LinkState& link)
    : settings_(settings),
      remote_adapter_(link.device_bus == "usb" || (link.device_bus.empty() && link.kind == "can")) {
}

std::int64_t FrameTimer::duration_ns(const CanFrame& frame) const {
  if (!settings_.correct_frame_duration) {
    return 0;
  }
  BitRates rates = settings_.bit_rates;
  if (rates.data_per_s <= 0.0) {
    rates.data_per_s = rates.nominal_per_s;
  }
  return std::llround(frame_duration_s(frame, rates) * 1e9);
}

std::int64_t FrameTimer::kernel_start_of_frame_ns(const CanFrame& frame) const {
  return frame.kernel_ns - duration_ns(frame) - std::llround(settings_.latency_s * 1e9);
}

std::int64_t FrameTimer::hardware_start_ns(const CanFrame& frame) const {
  switch (settings_.hardware_stamp_point) {
  case StampPoint::start_of_frame:
    return frame.hardware_ns;
  case StampPoint::end_of_frame:
    return frame.hardware_ns - duration_ns(frame);
  case StampPoint::unknown:
    break;
  }
  return frame.hardware_ns - duration_ns(frame) / 2; // either end is as far away
}

bool FrameTimer::add(const CanFrame& frame) {
  if (!uses_hardware_) {
    uses_hardware_ = settings_.use_hardware_stamps && frame.hardware_ns != 0;
  }
  max_duration_s_ = std::max(max_duration_s_, static_cast<double>(duration_ns(frame)) * 1e-9);
  if (!*uses_hardware_ || frame.hardware_ns == 0) {
    return true;
  }
  return hardware_line_.add(hardware_start_ns(frame), kernel_start_of_frame_ns(frame));
}

void FrameTimer::restart() {
  if (uses_hardware()) {
    hardware_line_.restart();
  }
}

std::optional<std::int64_t> FrameTimer::start_of_frame_ns(const CanFrame& frame) const {
  if (!uses_hardware() || frame.hardware_ns == 0) {
    return kernel_start_of_frame_ns(frame);
  }
  if (!hardware_line_.ready()) {
    return std::nullopt;
  }
  return hardware_line_.to_host(hardware_start_ns(frame));
}

std::optional<std::int64_t> FrameTimer::end_of_frame_ns(const CanFrame& frame) const {
  auto start = start_of_frame_ns(frame);
  if (start) {
    *start += duration_ns(frame);
  }
  return start;
}

double FrameTimer::u_common_s() const {
  const double bit_s =
      settings_.bit_rates.nominal_per_s > 0.0 ? 1.0 / settings_.bit_rates.nominal_per_s : 0.0;
  const bool unknown_point =
      uses_hardware() && settings_.hardware_stamp_point == StampPoint::unknown;
  const double u_instant_s = (unknown_point ? max_duration_s_ : bit_s) / std::sqrt(12.0);
  const double u_tick_s = uses_hardware() ? settings_.hardware_tick_s / std::sqrt(12.0) : 0.0;
  const double u_default_s = remote_adapter_   ? max_usb_latency_s / std::sqrt(3.0)
                             : uses_hardware() ? u_hardware_latency_s
                                               : u_kernel_latency_s;
  const double u_latency_s = settings_.u_latency_s.value_or(u_default_s);
  return std::sqrt(u_instant_s * u_instant_s + u_tick_s * u_tick_s + u_latency_s * u_latency_s);
}

} // namespace dyncal::drivers::can
