#include "analysis/method/start_latency.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::analysis {
namespace {

const double evidence = std::log(20.0);

double normal_distribution(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

} // namespace

StartLatency judge_start_latency(std::span<const double> offsets_s, double u_s, double sample_s) {
  StartLatency result;
  if (offsets_s.size() < 3 || !(sample_s > 0.0)) {
    return result;
  }
  const double n = static_cast<double>(offsets_s.size());
  double mean = 0.0;
  for (const double offset : offsets_s) {
    mean += offset / n;
  }
  double squares = 0.0;
  for (const double offset : offsets_s) {
    squares += (offset - mean) * (offset - mean);
  }
  result.scatter_s = std::sqrt(squares / (n - 1.0));
  const double u = std::max(u_s, 1e-6 * sample_s); // noise-free data must not divide by 0
  const auto [first, last] = std::minmax_element(offsets_s.begin(), offsets_s.end());
  const double centre = 0.5 * (*first + *last); // most likely place of the rectangle
  for (const double offset : offsets_s) {
    const double fixed =
        -0.5 * std::pow((offset - mean) / u, 2) - std::log(u * std::sqrt(2.0 * std::numbers::pi));
    const double from_centre = offset - centre;
    const double density = (normal_distribution((from_centre + 0.5 * sample_s) / u) -
                            normal_distribution((from_centre - 0.5 * sample_s) / u)) /
                           sample_s;
    result.log_likelihood_ratio += std::log(std::max(density, 1e-300)) - fixed;
  }
  const double uniform_s = sample_s / std::sqrt(12.0);
  result.too_wide_for_fixed = result.scatter_s >= 3.0 * u;
  result.too_wide_for_uniform = result.scatter_s >= 2.0 * std::hypot(uniform_s, u);
  if (result.log_likelihood_ratio < -evidence && !result.too_wide_for_fixed) {
    result.kind = StartKind::fixed;
  } else if (result.log_likelihood_ratio > evidence && result.scatter_s > 0.3 * uniform_s &&
             result.scatter_s < 2.0 * uniform_s) {
    result.kind = StartKind::uniform;
  }
  return result;
}

StartKind StartLatency::kind_after(StartKind other_steps) const {
  const bool contradicted = (other_steps == StartKind::fixed && too_wide_for_fixed) ||
                            (other_steps == StartKind::uniform && too_wide_for_uniform);
  return kind == StartKind::undecided && !contradicted ? other_steps : kind;
}

const char* to_string(StartKind kind) {
  switch (kind) {
  case StartKind::fixed:
    return "with the trigger";
  case StartKind::uniform:
    return "uniform over one sample after the trigger";
  case StartKind::undecided:
    break;
  }
  return "undecided, taken as with the trigger";
}

} // namespace dyncal::analysis
