// One frame of a stream: a sine of a known frequency in it, and how its residuals are spread over
// the frame.
//
// Three-parameter sine approximation (paper eq. (1)) about the means, which is all that a search
// for the excitation needs; sine_fit.hpp is for results. The phase is lead, about the middle of
// the frame. The residuals are also taken in slices of 50 ms, ten at least: an interruption within
// the frame shows as adjacent slices that the sine does not describe.
//
// Empty when sine and cosine look alike at these instants (a frequency at a multiple of half the
// sample rate). REQUIRES: stamps that rise, as many values, more than three. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct FrameSine {
  double amplitude = 0.0;
  double u_amplitude = 0.0;
  double phase_rad = 0.0;
  double residual_rms = 0.0;
  double max_residual = 0.0;
  double max_neighbours_rms = 0.0; // the larger of each two adjacent slices' smaller one
};

// A frame long enough to tell the frequency from those beside it: a period at least, 50 of them or
// 0.1 s as a rule, and two turns of the nearest lines of a multi-sine against each other.
[[nodiscard]] std::int64_t frame_length_ns(const Frequency& frequency,
                                           const std::vector<Frequency>& beside);

[[nodiscard]] std::optional<FrameSine> fit_frame(const Frequency& frequency, std::int64_t begin_ns,
                                                 std::int64_t frame_ns,
                                                 std::span<const std::int64_t> stamps_ns,
                                                 std::span<const double> values);

} // namespace dyncal::analysis
