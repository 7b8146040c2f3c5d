// A curve between the points of a table over frequency: the value, and a bound of what a straight
// line misses.
//
//   y = y_i + w (y_{i+1} - y_i)        w over frequency, or over its logarithm
//   |missed| <= c (x - x_i)(x_{i+1} - x)     c: half the curvature
//
// The logarithm is taken where it predicts points from their neighbours better, as it does
// near the corner of a high pass; the curve is exact at the points. c is the larger of the second
// differences on both sides. At an end there is only the inner one: it is multiplied by what the
// second differences grow towards that end (at most 4, and 3 where a table of three points does not
// show it), or the next one where that is above 4 times as large. Where points near the interval,
// one more on either side, lie both above and below the line through their neighbours, the curve
// turns back: then at least 1.5 times the largest of those, as in an interval of that length; the
// same where they lie on one side and the points next to them show that the table is coarse: they
// go to the other side, or up and down again, from one point to the next, as a wave of fewer than
// seven points a period does. Four points do not show such a wave, and no table what turns back
// twice between two of its points. A table of two points shows no curvature: then twice the
// difference of the two lines is taken for it, as 1 / f has it.
//
// Phases are unwrapped first: to the turn that the slope before predicts, so that +179 and -179
// degrees are 2 degrees apart and a delay is followed over steps of more than half a turn. A step
// that comes near half a turn, or that slope and nearest turn take differently without agreement
// within 1 rad, is `ambiguous`: the table does not tell the phase in that interval, and the caller
// adds `ambiguous_phase_rad`.
//
// Plain functions of valid tables: frequencies rising and positive, two points and more. Any
// thread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace dyncal::analysis {

struct CurveValue {
  double value = 0.0;
  double missed = 0.0; // half width
  double weight = 0.0; // w
};

// Between the points i and i + 1.
[[nodiscard]] CurveValue curve_between_points(std::span<const double> frequencies_hz,
                                              std::span<const double> values, std::size_t i,
                                              double frequency_hz);

struct UnwrappedPhases {
  std::vector<double> phases_rad;
  std::vector<bool> ambiguous; // of the interval from each point to the next
};

[[nodiscard]] UnwrappedPhases unwrap_over_frequency(std::span<const double> frequencies_hz,
                                                    std::span<const double> phases_rad);

// How far both ways of unwrapping are apart at most at `weight`.
[[nodiscard]] double ambiguous_phase_rad(double weight);

} // namespace dyncal::analysis
