#include "analysis/uncertainty/found_resolution.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace dyncal::analysis {
namespace {

constexpr std::size_t max_values = 4096;
constexpr double allowed_error = 0.02; // of a multiple, in steps
constexpr double allowed_misfits = 0.01;
constexpr double chance = 1e-6; // that continuous values fit
constexpr std::size_t min_values = 16;
constexpr double repeats = 4.0;   // values a level, on average, of a signal of a few levels
constexpr int max_divisor = 6;    // of the smallest difference
constexpr double rounding = 1e-7; // of the largest value: numbers may be single precision

std::vector<double> sorted_sample(std::span<const double> values) {
  std::vector<double> sample;
  const std::size_t stride =
      std::max<std::size_t>(1, (values.size() + max_values - 1) / max_values);
  for (std::size_t i = 0; i < values.size(); i += stride) {
    if (std::isfinite(values[i])) {
      sample.push_back(values[i]);
    }
  }
  std::sort(sample.begin(), sample.end());
  return sample;
}

// Distances between neighbouring levels; values closer than rounding are one level.
std::vector<double> distances(const std::vector<double>& sorted) {
  const double same = rounding * std::max(std::abs(sorted.front()), std::abs(sorted.back()));
  std::vector<double> result;
  double level = sorted.front();
  for (const double value : sorted) {
    if (value - level > same) {
      result.push_back(value - level);
      level = value;
    }
  }
  return result;
}

double misfit(double distance, double step) {
  const double multiple = distance / step;
  return std::abs(multiple - std::round(multiple));
}

// The part of the distances that are no whole multiples.
double misfits(const std::vector<double>& all, double step) {
  const auto count = std::count_if(all.begin(), all.end(), [step](double distance) {
    return misfit(distance, step) > allowed_error;
  });
  return static_cast<double>(count) / static_cast<double>(all.size());
}

// The mean over many multiples is better than one difference, whose rounding would count hundreds
// of times in a long distance: the shorter ones tell how many steps the longer ones have. REQUIRES:
// distances in their order.
double refined(const std::vector<double>& in_order, double step) {
  double multiples = 0.0, sum = 0.0;
  for (const double distance : in_order) {
    const double multiple = std::round(distance / step);
    if (multiple > 0.0 && misfit(distance, step) <= allowed_error) {
      multiples += multiple;
      sum += distance;
      step = sum / multiples;
    }
  }
  return step;
}

} // namespace

double found_resolution(std::span<const double> values) {
  const std::vector<double> sorted = sorted_sample(values);
  if (sorted.size() < min_values) {
    return 0.0;
  }
  const std::vector<double> all = distances(sorted);
  if (all.empty()) {
    return 0.0;
  }
  // One of the smallest; the very smallest may be one of the misfits.
  std::vector<double> order = all;
  std::sort(order.begin(), order.end());
  const auto low = static_cast<std::size_t>(allowed_misfits * static_cast<double>(all.size()));
  for (int divisor = 1; divisor <= max_divisor; ++divisor) {
    const double step = refined(order, order[low] / divisor);
    if (misfits(all, step) > allowed_misfits) {
      continue;
    }
    const double by_chance = std::pow(2.0 * allowed_error, static_cast<double>(all.size()) - 1.0);
    const bool few_levels =
        static_cast<double>(sorted.size()) > repeats * static_cast<double>(all.size() + 1);
    if (by_chance < chance || few_levels) {
      return step;
    }
  }
  return 0.0;
}

} // namespace dyncal::analysis
