#include "analysis/uncertainty/scatter_grid.hpp"

#include <cmath>
#include <numeric>

namespace dyncal::analysis {
namespace {

constexpr double grid_low = 0.03;
constexpr double grid_high = 3e4;
// In units of u. At 0.2, scatter of 2 to 5 u is covered 93..94 %, and sweeps of few frequencies
// that scatter by 5 to 20 u as well; at 1, single frequencies are 1.8 times as wide without
// scatter.
constexpr double bend_of_runs = 0.5;
constexpr double bend_of_sweeps = 1.0;
// Of one frequency: what n runs leave open of a scatter of about the noise grows less with n than
// its prior must. 95.4 % at worst for n = 3 to 20; with 0.5 for all n 94.5 %, at 2 u.
constexpr double bend_a_run = 0.25;

ScatterGrid prior(double bend) {
  ScatterGrid weights{};
  const double step = std::log(grid_high / grid_low) / double{scatter_grid_steps};
  for (std::size_t i = 0; i < scatter_grid_steps; ++i) {
    weights[i] = step * scatter_grid()[i] / (bend + scatter_grid()[i]);
  }
  weights[scatter_grid_steps] = std::log1p(grid_low / bend);
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) {
    weight /= total;
  }
  return weights;
}

} // namespace

const ScatterGrid& scatter_grid() {
  static const ScatterGrid points = [] {
    ScatterGrid result{};
    for (std::size_t i = 0; i < scatter_grid_steps; ++i) {
      result[i] = grid_low * std::pow(grid_high / grid_low,
                                      (static_cast<double>(i) + 0.5) / double{scatter_grid_steps});
    }
    return result;
  }();
  return points;
}

const ScatterGrid& scatter_prior() {
  static const ScatterGrid weights = prior(bend_of_runs);
  return weights;
}

ScatterGrid scatter_prior_of_few(std::size_t runs) {
  return prior(bend_a_run * static_cast<double>(runs));
}

const ScatterGrid& sweep_scatter_prior() {
  static const ScatterGrid weights = prior(bend_of_sweeps);
  return weights;
}

} // namespace dyncal::analysis
