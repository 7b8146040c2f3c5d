// What a channel makes of the lines of a multi-sine, read from the lines that nobody excites:
// harmonics and intermodulation.
//
//   P_b = 2/n sum e_i (sin w_b t_i, cos w_b t_i),   b: 2 k_a, 3 k_a, k_a +- k_b below 0.45 of the
//                                                   mean sample rate, each once
//   distortion = sqrt(sum (|P_b|^2 - 4 s^2 / n) / sum |P_k|^2)
//
// e is what the joint fit of the lines leaves (separated_lines.hpp), without a straight line; s its
// standard deviation without these products. u is what noise alone gives. A sensor of second order
// c, y = x + c x^2, shows about c sqrt(sum |P_k|^2); nothing of that is on an excited line, as all
// lines are odd (multisine_lines.hpp).
//
// REQUIRES: lines of the period, a channel of `record`. Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/separated_lines.hpp"

namespace dyncal::analysis {

struct LineProducts {
  double distortion = 0.0; // of the lines together
  double u_distortion = 0.0;
  std::size_t looked_at = 0;
  double noise_part = 1.0; // of the standard deviation of e: what is noise, and none of these
};

[[nodiscard]] LineProducts measure_line_products(std::span<const Frequency> lines, double period_s,
                                                 const SeparatedLines& record, std::size_t channel,
                                                 std::span<const std::int64_t> stamps_ns);

} // namespace dyncal::analysis
