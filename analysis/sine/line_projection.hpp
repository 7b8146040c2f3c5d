// What a record shows at one frequency, line by line:
//
//   P = 2/n sum y_i (sin w (t_i - t_0) + i cos w (t_i - t_0))
//
// the A + iB of a sine where the record holds whole turns of it, or many. For lines that a fit of
// others has left. Plain functions, any thread.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

// REQUIRES: as many stamps as values, one at least.
[[nodiscard]] std::complex<double> line_projection(const Frequency& frequency,
                                                   std::int64_t origin_ns,
                                                   std::span<const std::int64_t> stamps_ns,
                                                   std::span<const double> values);

// Without the straight line through them, by sums about the middle. REQUIRES: two values.
[[nodiscard]] std::vector<double> without_trend(std::span<const double> values);

} // namespace dyncal::analysis
