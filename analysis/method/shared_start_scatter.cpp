#include "analysis/method/shared_start_scatter.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {
namespace {

constexpr double most_of_a_step = 7.0;
constexpr double significant = 10.0; // chi-squared of one degree of freedom, s not below 0: 1e-3
constexpr double as_likely = 1.0;    // one standard uncertainty of s
constexpr double narrowest = 0.05;   // of the least u: less cannot be significant
constexpr double step_factor = 1.1;  // of s: finer than any run can tell

bool counts(const StartEvidence& step) {
  return step.shots > 1 && step.u_s > 0.0;
}

double evidence_of(const StartEvidence& step, double scatter_s) {
  const double u2 = step.u_s * step.u_s;
  const double ratio = scatter_s * scatter_s / u2;
  const double evidence = step.squares_s2 / u2 * ratio / (1.0 + ratio) -
                          (static_cast<double>(step.shots) - 1.0) * std::log1p(ratio);
  return std::min(evidence, most_of_a_step);
}

double evidence_of(std::span<const StartEvidence> steps, double scatter_s) {
  double sum = 0.0;
  for (const StartEvidence& step : steps) {
    sum += counts(step) ? evidence_of(step, scatter_s) : 0.0;
  }
  return sum;
}

} // namespace

std::optional<SharedStartScatter> shared_start_scatter(std::span<const StartEvidence> steps) {
  double least_s = 0.0;
  double most_s = 0.0;
  for (const StartEvidence& step : steps) {
    if (counts(step)) {
      least_s = least_s > 0.0 ? std::min(least_s, step.u_s) : step.u_s;
      most_s = std::max({most_s, step.u_s, std::sqrt(step.squares_s2)});
    }
  }
  double most = 0.0;
  for (double s = narrowest * least_s; s > 0.0 && s < most_s; s *= step_factor) {
    most = std::max(most, evidence_of(steps, s));
  }
  if (most < significant) {
    return std::nullopt;
  }
  SharedStartScatter found;
  for (double s = narrowest * least_s; s < most_s; s *= step_factor) {
    found.scatter_s = evidence_of(steps, s) > most - as_likely ? s : found.scatter_s;
  }
  found.u_latency_s = std::sqrt(4.0 / 3.0) * found.scatter_s;
  return found;
}

} // namespace dyncal::analysis
