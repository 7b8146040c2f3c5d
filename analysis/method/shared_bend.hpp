// Does the sensor's clock drift within its triggered series, where a step's own shots hide it?
//
//   d_ik = turn_ik / w_i, u(d_ik)      by what bends all series of step i alike, in order k = 2, 3
//                                      of the time, its first sample is off (series_blocks.hpp)
//
// One clock bends the series of all steps by the same time, which phases show best at high
// frequencies. A step shows a bend where sum_k (d_k / u_k)^2 is above 23: chance, 1e-5. Another one
// shares it unless it excludes it,
//
//   sum_k (d_ik - d_jk)^2 / (u_ik^2 + u_jk^2) > 13.8      chance, 1e-3
//
// as it does where a sample was lost in the other one alone. All series are of about one length.
//
// Plain function, any thread.
#pragma once

#include <span>
#include <vector>

#include "analysis/method/series_blocks.hpp"

namespace dyncal::analysis {

struct StepBend {
  double angular_hz = 0.0;
  SeriesBend bend;
};

// For each step, whether it shows a bend or shares that of another.
[[nodiscard]] std::vector<bool> steps_that_bend(std::span<const StepBend> steps);

} // namespace dyncal::analysis
