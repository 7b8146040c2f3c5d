// The square of the amplitude of a line that was measured at other times, seen there or not: what
// it contributes where it cannot be measured.
//
//   E[h^2] = integral h^2 L(h) dh / integral L(h) dh      L = product of the Rice densities of a_i
//
// a_i: measured amplitudes, each with the uncertainty u_i of its components; nothing is known of h
// beforehand but that it is not negative. Where noise alone was seen, the root of this is 0.98 u of
// one measurement and falls with the fourth root of their number: less than an upper limit, so that
// what is not there costs little. Lines that stand out of their noise (4.5 u) need not be the same
// at all times: then the largest amplitude counts.
//
// Empty without measurements. Unit: square of that of the amplitudes. Any thread.
#pragma once

#include <optional>
#include <span>

namespace dyncal::analysis {

struct MeasuredAmplitude {
  double amplitude = 0.0;
  double u_component = 0.0;
};

// E[h^2] whatever the amplitudes; 0 where an uncertainty is 0. REQUIRES: amplitudes of some u.
[[nodiscard]] double expected_square(std::span<const MeasuredAmplitude> measured);

[[nodiscard]] std::optional<double>
square_of_amplitude(std::span<const MeasuredAmplitude> measured);

} // namespace dyncal::analysis
