#include "analysis/uncertainty/sweep_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace dyncal::analysis {
namespace {

std::vector<std::uint32_t> repetitions_of(const RepeatedQuantity& quantity) {
  if (!quantity.repetitions.empty()) {
    return quantity.repetitions;
  }
  std::vector<std::uint32_t> result(quantity.deviations.size());
  std::iota(result.begin(), result.end(), 1U);
  return result;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

} // namespace

SweepScatter::SweepScatter(std::span<const RepeatedQuantity> quantities,
                           std::span<const double> noise, std::span<const double> unit,
                           const std::vector<bool>& takes_part, double tau_d)
    : loadings_(quantities.size(), 0.0), parts_(quantities.size()) {
  for (std::size_t f = 0; f < quantities.size(); ++f) {
    if (!takes_part[f]) {
      continue;
    }
    const double scatter = unit[f] * tau_d;
    const double variance = noise[f] * noise[f] + scatter * scatter;
    const double middle = mean_of(quantities[f].deviations);
    loadings_[f] = unit[f] * unit[f] / variance;
    for (const double value : quantities[f].deviations) {
      parts_[f].push_back(unit[f] * (value - middle) / variance);
    }
    loading_ += loadings_[f];
    sums_.resize(parts_[f].size(), 0.0);
    std::transform(sums_.begin(), sums_.end(), parts_[f].begin(), sums_.begin(), std::plus<>());
  }
  log_excess_ =
      log_excess_of({loading_, std::inner_product(sums_.begin(), sums_.end(), sums_.begin(), 0.0)});
}

SweepScatter::Sums SweepScatter::sums_without(std::size_t frequency) const {
  const std::vector<double>& own = parts_[frequency];
  Sums result{std::max(0.0, loading_ - loadings_[frequency]), 0.0};
  for (std::size_t r = 0; r < sums_.size(); ++r) {
    const double sum = sums_[r] - (own.empty() ? 0.0 : own[r]);
    result.squares += sum * sum;
  }
  return result;
}

ScatterGrid SweepScatter::log_excess_without(std::size_t frequency) const {
  return log_excess_of(sums_without(frequency));
}

// With x = a tau_c^2 / (1 + a tau_c^2) it is half of x squares / a + freedom log(1 - x).
double SweepScatter::most_without(std::size_t frequency) const {
  const Sums sums = sums_without(frequency);
  const double freedom = static_cast<double>(sums_.size()) - 1.0;
  if (!(sums.squares > freedom * sums.loading) || !(sums.loading > 0.0)) {
    return 0.0;
  }
  const double ratio = sums.squares / sums.loading;
  return 0.5 * (ratio - freedom - freedom * std::log(ratio / freedom));
}

ScatterGrid SweepScatter::log_excess_of(const Sums& sums) const {
  const double freedom = static_cast<double>(sums_.size()) - 1.0;
  ScatterGrid result{};
  for (std::size_t i = 0; i < scatter_grid_points; ++i) {
    const double variance = scatter_grid()[i] * scatter_grid()[i];
    const double ratio = 1.0 + variance * sums.loading;
    result[i] = 0.5 * (variance / ratio * sums.squares - freedom * std::log(ratio));
  }
  return result;
}

std::optional<std::vector<bool>>
frequencies_in_sweeps(std::span<const RepeatedQuantity> quantities) {
  std::map<std::vector<std::uint32_t>, std::size_t> counts;
  for (const RepeatedQuantity& quantity : quantities) {
    if (quantity.deviations.size() > 1) {
      ++counts[repetitions_of(quantity)];
    }
  }
  const auto most =
      std::max_element(counts.begin(), counts.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most == counts.end() || most->second < 2) {
    return std::nullopt;
  }
  std::vector<bool> result;
  std::transform(quantities.begin(), quantities.end(), std::back_inserter(result),
                 [&](const RepeatedQuantity& one) { return repetitions_of(one) == most->first; });
  return result;
}

} // namespace dyncal::analysis
