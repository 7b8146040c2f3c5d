// How well the host's clock is known to agree with UTC, as the kernel's clock discipline says it
// (ntp_adjtime, whichever of chrony, ntpd, ptp4l with phc2sys disciplines it). Any thread.
#pragma once

namespace dyncal::drivers::can {

// Standard uncertainty of a clock of which nobody knows whether anything disciplines it: 9.2 s.
[[nodiscard]] double u_undisciplined_clock_s();

struct ClockQuality {
  bool synchronized = false;
  double u_s = 0.0; // standard uncertainty: the kernel's bound of the error, taken as rectangular.
                    // 9 s when nothing disciplines the clock
};

[[nodiscard]] ClockQuality system_clock_quality();

} // namespace dyncal::drivers::can
