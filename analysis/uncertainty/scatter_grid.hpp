// The values that a scatter from run to run may have, with their prior probabilities, for
// integration by quadrature.
//
//   p(tau) ~ 1 / (0.5 u + tau)    of runs of many frequencies    from 0.03 u to 3e4 u in
//   logarithmic p(tau) ~ 1 / (n u / 4 + tau)  of n runs of few frequencies   steps, and one point
//   for 0 p(tau) ~ 1 / (u + tau)        of sweeps
//
// in units of the noise u. The last point is 0 and stands for all below the first as well. Plain
// tables, made once; any thread.
#pragma once

#include <array>
#include <cstddef>

namespace dyncal::analysis {

inline constexpr std::size_t scatter_grid_steps = 80;
inline constexpr std::size_t scatter_grid_points = scatter_grid_steps + 1;

using ScatterGrid = std::array<double, scatter_grid_points>;

[[nodiscard]] const ScatterGrid& scatter_grid();
[[nodiscard]] const ScatterGrid& scatter_prior(); // all together 1
[[nodiscard]] ScatterGrid scatter_prior_of_few(std::size_t runs);
[[nodiscard]] const ScatterGrid& sweep_scatter_prior();

} // namespace dyncal::analysis
