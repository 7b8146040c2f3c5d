// Is the series of a channel that carries a multi-sine what its sensor felt? End stops and stuck
// values of the whole signal; what single lines do not show (signal_integrity.hpp).
//
//   at range    values within half a resolution of an end of the stated range, or beyond it
//   clipped     values equal to the record's own highest or lowest, three at least, at which the
//               sum of the lines goes on by more than a resolution and four standard errors
//   stuck       four equal values or more while the sum of the lines moves by more than two
//               resolutions, six times the noise and a fiftieth of its rms
//
// End stops take as much off the lines as the part of the values that they stop: a signal of many
// lines is nearly normal, and one clipped at +-c keeps 1 - P(|x| > c) of its gain (Bussgang 1952).
// That part is `at_range_part` and `clipping_rel`. A crest factor of 3.5 takes a multi-sine there
// although every line is small. REQUIRES: as many values as `rest`, what the joint fit of the lines
// leaves of them (sine/separated_lines.hpp). Any thread.
#pragma once

#include <span>

#include "analysis/step/signal_integrity.hpp"

namespace dyncal::analysis {

// Into the members of `integrity` that are about these, and no other.
void measure_compound_integrity(std::span<const double> values, std::span<const double> rest,
                                const SignalExpectation& expected, SignalIntegrity& integrity);

} // namespace dyncal::analysis
