// The square of the amplitude that the background of a channel (hum, ripple, narrow-band noise) has
// at a frequency where a step excites, from what steps of other frequencies showed there.
//
//   z = sum a_i^2 / sum 2 u_i^2      1 where there is noise alone: about F of 2 n and 12 n degrees
//
// significant   z exceeds what noise gives 3 times in 100 000 (Wilson and Hilferty), or one a_i
//               exceeds 8.4 u, or all of them what u of the step holds of noise already (once in
//               10^4) and 2.5 times the noise beside, which noise of a width raises too: h^2 is the
//               mean of the larger half of a_i^2 - 2 u_i^2, so that what comes and goes is not
//               averaged away, nor one disturbed step taken for all; times 1 + 3 / n^2, for one or
//               two amplitudes of narrow-band noise say little of its power (with it 94 % are
//               covered for n = 1, 96 % and more from n = 2 on).
// else          h^2 = expected_square() (line_power.hpp): what is not there costs little.
//
// What grows with the drive is larger where more is driven: each a_i comes with the amplitude A_i
// of the excitation, and h is taken for the amplitude A as a_i, or as a_i A / A_i, whichever agrees
// better among the measurements; where they do not say (all were driven alike), as the larger.
//
// Units: h and a_i of the channel. Nothing fails. Any thread.
#pragma once

#include <optional>
#include <span>

#include "analysis/uncertainty/line_power.hpp"

namespace dyncal::analysis {

struct MeasuredBackground {
  MeasuredAmplitude line;
  double excitation = 0.0; // A_i, in the unit of the channel
};

// h^2 where it is significant. `constant`: it is known not to grow with the drive.
// `accounted`: what u of the step holds of noise at its frequency, of either component; 0: unknown.
[[nodiscard]] std::optional<double>
significant_background(std::span<const MeasuredBackground> measured, double excitation,
                       bool constant = false, double accounted = 0.0);

// h^2 where it is not: the same whatever is excited; 0 without measurements.
[[nodiscard]] double expected_background(std::span<const MeasuredBackground> measured);

} // namespace dyncal::analysis
