#include "services/evaluation/sweep_delay.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/response/delay_branches.hpp"
#include "analysis/uncertainty/random_effects.hpp"

namespace dyncal::inline evaluation {
namespace {

// Less would add the scatter of noise to the group delay of every clean run of few repetitions;
// more would leave out delays that are seen.
constexpr double once_in_twenty = 1.645; // normal quantile

using PhasesOfSweeps = std::map<std::uint32_t, std::vector<analysis::PhasePoint>>;

analysis::RepeatedQuantity delays_of(const PhasesOfSweeps& sweeps) {
  analysis::RepeatedQuantity delays;
  for (const auto& [sweep, points] : sweeps) {
    if (points.size() < 2) {
      continue; // tells no delay from a phase
    }
    std::vector<double> phases_rad;
    for (const analysis::PhasePoint& point : points) {
      phases_rad.push_back(point.phase_rad);
    }
    const analysis::DelayLine line = analysis::fit_delay_line(points, phases_rad);
    delays.deviations.push_back(line.delay_s);
    delays.u.push_back(std::sqrt(line.variance_delay));
  }
  return delays;
}

bool scatter_more_than_noise(const analysis::RepeatedQuantity& delays) {
  double weights = 0.0, weighted = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < delays.u.size(); ++i) {
    const double weight = 1.0 / (delays.u[i] * delays.u[i]);
    weights += weight;
    weighted += weight * delays.deviations[i];
    squares += weight * delays.deviations[i] * delays.deviations[i];
  }
  const double freedom = static_cast<double>(delays.u.size()) - 1.0;
  const double chi_squared = squares - weighted * weighted / weights;
  return chi_squared > freedom * analysis::chi_squared_limit(freedom, once_in_twenty);
}

} // namespace

analysis::CombinedUncertainty u_delay_of_sweeps(std::span<const SweepPhase> phases) {
  PhasesOfSweeps sweeps;
  for (const SweepPhase& phase : phases) {
    if (phase.u_phase_rad > 0.0) {
      sweeps[phase.sweep].push_back({phase.frequency_hz, phase.deviation_rad, phase.u_phase_rad});
    }
  }
  for (auto& [sweep, points] : sweeps) {
    std::sort(points.begin(), points.end(),
              [](const auto& a, const auto& b) { return a.frequency_hz < b.frequency_hz; });
  }
  const analysis::RepeatedQuantity delays = delays_of(sweeps);
  if (delays.u.size() < 2 || !scatter_more_than_noise(delays)) {
    return {};
  }
  const auto mean = analysis::errors_of_means(std::span(&delays, 1));
  analysis::CombinedUncertainty result = analysis::combine(mean.front(), 0.0);
  const double half = 0.5 * result.expanded();
  double noise = 0.0; // of the mean, squared
  for (const double u : delays.u) {
    noise += u * u / std::pow(static_cast<double>(delays.u.size()), 2);
  }
  result.u = 2.0 / result.k * std::sqrt(std::max(0.0, half * half - noise));
  return result;
}

} // namespace dyncal::inline evaluation
