// The motion of a step without the slow motion of the table, from the displacement or velocity of a
// reference, as samples that the sine approximation takes like those of any transducer.
//
//   1. The samples go through a filter (decimation_filter.hpp) to fd = 4..8 f; gaps and samples
//   that
//      were left out cut them into parts that are filtered each by itself. So do the stamps, which
//      need not be even.
//   2. d_n = x_(n+1) - 2 x_n + x_(n-1), whose gain at f is -4 sin(w / 2 fd)^2.
//   3. They are divided by both gains at f, exactly: the sine of the step keeps amplitude and
//   phase,
//      in the unit that it had. Its acceleration is -w^2 times it (of a velocity i w times it).
//
// The residuals of a sine fitted to that are not white: the filter takes from the upper end of the
// band, so the noise near f is `noise_factor` times what the fit takes it for, where the
// acceleration of the table is white noise (displacement: 1.07 near 4.2 f, up to 1.25). White noise
// of the detectors is stated as it is near fd = 4 f, and too large above 5 f, which only a sample
// rate below 8.4 f leads to; that of a velocity up to 1.4 times too large.
//
// The order matters. A sine fitted to the displacement takes the slow motion of the table for
// excitation (1 kHz, 0.1 m/s^2 beside 1.2 um: 14 %); the second difference at the full rate lets
// the noise of all frequencies in.
//
// Right at the frequency of the step only: other lines of the spectrum keep the gains of filter and
// difference. Fails: frequency_out_of_range (fs < 4 f), too_few_samples, invalid_argument (sizes,
// stamps that do not increase). Any thread.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

enum class MotionQuantity { acceleration, velocity, displacement };

[[nodiscard]] std::string_view to_string(MotionQuantity quantity);

// What a quantity's phasor is multiplied by for that of another: (i w)^n.
[[nodiscard]] std::complex<double> motion_factor(MotionQuantity from, MotionQuantity to,
                                                 double angular_hz);

struct StepMotion {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values; // in the unit of the samples
  double noise_factor = 1.0;  // by which the standard uncertainty of a sine fit is multiplied
  double rate_hz = 0.0;       // fd
};

// `quantity`: of the values. REQUIRES: not an acceleration, whose samples need none of this.
[[nodiscard]] Expected<StepMotion> motion_of_step(MotionQuantity quantity,
                                                  const Frequency& frequency,
                                                  std::span<const std::int64_t> stamps_ns,
                                                  std::span<const double> values);

// The samples without their means over a period of the step, about each: the sine with its
// harmonics and the noise, at the full rate. For what looks at the shape of a signal and at lines
// beside the step, which a drift a thousand times larger would hide; the sine keeps its amplitude
// within 1 / n of n samples a period. As many values as samples. REQUIRES: as many stamps, which
// increase.
[[nodiscard]] std::vector<double> without_slow_motion(double frequency_hz,
                                                      std::span<const std::int64_t> stamps_ns,
                                                      std::span<const double> values);

// The samples of those that have half a period on either side without a gap: what
// without_slow_motion() leaves of the others still holds some of the drift, by which single samples
// stand out. As many values as stamps.
struct CentredSamples {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
};
[[nodiscard]] CentredSamples centred_samples(double frequency_hz,
                                             std::span<const std::int64_t> stamps_ns,
                                             std::span<const double> values);

} // namespace dyncal::analysis
