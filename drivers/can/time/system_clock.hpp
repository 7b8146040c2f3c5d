// How well the host's clock is known to agree with UTC.
//
// As the kernel's clock discipline reports it (ntp_adjtime; chrony, ntpd, or ptp4l with phc2sys may
// be the one that disciplines it). Any thread.
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
