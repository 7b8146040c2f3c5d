#include "analysis/uncertainty/scatter_grid.hpp"

#include <cmath>
#include <numeric>

namespace dyncal::analysis {
namespace {

constexpr double grid_low = 0.03;
constexpr double grid_high = 3e4;
constexpr double prior_bend = 0.2;

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
  static const ScatterGrid weights = [] {
    ScatterGrid result{};
    const double step = std::log(grid_high / grid_low) / double{scatter_grid_steps};
    for (std::size_t i = 0; i < scatter_grid_steps; ++i) {
      result[i] = step * scatter_grid()[i] / (prior_bend + scatter_grid()[i]);
    }
    result[scatter_grid_steps] = std::log1p(grid_low / prior_bend);
    const double total = std::accumulate(result.begin(), result.end(), 0.0);
    for (double& weight : result) {
      weight /= total;
    }
    return result;
  }();
  return weights;
}

} // namespace dyncal::analysis
