// How well a line of a multi-sine is known, by the lines beside it that nobody excites.
//
//   r_b = P_b / P_k of the sensor - P_b / P_k of the reference,   b = k +- 2, +- 4 ... +- 10
//   u^2 = sum |r_b|^2 / 2 n                                       of magnitude (relative) and phase
//
// P_b of what the joint fit of the lines has left. Odd lines alone: noise of any colour, and what a
// sensor of third order makes of the excitation, are there as they are at the line itself. What
// both channels show alike, as where the exciter's amplitude swings, is none of the ratio's, and
// cancels. Whatever is more than `stated` counts, by chance too: of ten lines that adds 12 % to the
// square of u where there is nothing.
//
// REQUIRES: lines of the period. Any thread.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct LineOfChannel {
  std::complex<double> phasor;            // of the line, about origin_ns
  std::span<const double> rest;           // what the joint fit has left
  std::span<const std::int64_t> times_ns; // of these
  std::int64_t origin_ns = 0;
  std::int64_t shift_ns = 0; // of its times to the time scale that both are compared on
};

// The relative u that `stated`, that of the noise, lacks; 0: nothing.
[[nodiscard]] double neighbour_noise_beyond(double stated, std::span<const Frequency> lines,
                                            std::size_t line, double period_s,
                                            const LineOfChannel& reference,
                                            const LineOfChannel& sensor);

} // namespace dyncal::analysis
