#include "analysis/method/shared_start_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace dyncal::analysis {
namespace {

constexpr double most_of_a_step = 20.0; // more than what shows a scatter, less than one wild shot
constexpr double significant = 10.0;    // chi-squared of one degree of freedom, s not below 0: 1e-3
constexpr double probable_none = 0.6;
constexpr double scale_of_prior = 2.0;     // u*
constexpr double latency_of_mean = 2.0;    // sqrt(3) of a rectangle, and its own scatter
constexpr double latency_of_doubt = 4.4;   // the least that holds 95 % of rectangles of 1 to 3 u*
constexpr double doubt_of_lone_step = 2.6; // U at most 1.5 times what clean errors make it
constexpr double doubt_of_two_steps = 3.8; // the same
constexpr double narrowest = 0.03;         // u*: less does not matter
constexpr double widest = 30.0;            // of the noisiest or most scattered step
constexpr double step_factor = 1.05;       // of s: finer than any run can tell

double latency_of_doubt_from(std::size_t steps) {
  switch (steps) {
  case 1:
    return doubt_of_lone_step;
  case 2:
    return doubt_of_two_steps;
  default:
    return latency_of_doubt;
  }
}

bool counts(const StartEvidence& step) {
  return step.shots > 1 && step.u_s > 0.0;
}

// Values of s, even in the logarithm.
struct Grid {
  double resolved_s = 0.0; // u*
  std::vector<double> scatters_s;
};

Grid grid_for(std::span<const StartEvidence> steps) {
  double sharpness = 0.0;
  double most_s = 0.0;
  for (const StartEvidence& step : steps) {
    sharpness += (static_cast<double>(step.shots) - 1.0) / std::pow(step.u_s, 4);
    most_s = std::max({most_s, step.u_s, std::sqrt(step.squares_s2)});
  }
  Grid grid;
  grid.resolved_s = std::pow(sharpness, -0.25);
  for (double s = narrowest * grid.resolved_s; s < widest * most_s; s *= step_factor) {
    grid.scatters_s.push_back(s);
  }
  return grid;
}

double evidence_of(const StartEvidence& step, double scatter_s) {
  const double u2 = step.u_s * step.u_s;
  const double ratio = scatter_s * scatter_s / u2;
  return step.squares_s2 / u2 * ratio / (1.0 + ratio) -
         (static_cast<double>(step.shots) - 1.0) * std::log1p(ratio);
}

// Adds what the step tells of every s against 0.
void add_evidence(const StartEvidence& step, const Grid& grid, std::vector<double>& sum) {
  std::vector<double> evidence;
  std::transform(grid.scatters_s.begin(), grid.scatters_s.end(), std::back_inserter(evidence),
                 [&](double s) { return evidence_of(step, s); });
  const auto best = std::max_element(evidence.begin(), evidence.end());
  const double floor = std::max(0.0, *best) - most_of_a_step;
  const double of_none = std::max(0.0, floor);
  for (auto one = evidence.begin(); one != evidence.end(); ++one) {
    const double told = one < best ? std::max(*one, floor) : *one;
    sum[static_cast<std::size_t>(one - evidence.begin())] += told - of_none;
  }
}

struct Moments {
  double mean_s = 0.0, mean_square_s2 = 0.0;
};

// Of s after the shots were seen, 0 among its values.
Moments moments_of(const Grid& grid, const std::vector<double>& evidence) {
  const double most = std::max(0.0, *std::max_element(evidence.begin(), evidence.end()));
  const double scale_s = scale_of_prior * grid.resolved_s;
  double prior = 0.0, total = 0.0, sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    const double s = grid.scatters_s[i];
    const double weight = s / (1.0 + std::pow(s / scale_s, 2)); // s: of a logarithmic grid
    const double likely = weight * std::exp(0.5 * (evidence[i] - most));
    prior += weight;
    total += likely;
    sum += likely * s;
    squares += likely * s * s;
  }
  total += prior * probable_none / (1.0 - probable_none) * std::exp(-0.5 * most);
  return {sum / total, squares / total};
}

} // namespace

std::optional<SharedStartScatter> shared_start_scatter(std::span<const StartEvidence> steps) {
  std::vector<StartEvidence> counted;
  std::copy_if(steps.begin(), steps.end(), std::back_inserter(counted), counts);
  if (counted.empty()) {
    return std::nullopt;
  }
  const Grid grid = grid_for(counted);
  std::vector<double> evidence(grid.scatters_s.size(), 0.0);
  for (const StartEvidence& step : counted) {
    add_evidence(step, grid, evidence);
  }
  SharedStartScatter found;
  const auto [mean_s, mean_square_s2] = moments_of(grid, evidence);
  const double doubt_s = std::sqrt(std::max(0.0, mean_square_s2 - mean_s * mean_s));
  found.scatter_s = std::sqrt(mean_square_s2);
  found.u_latency_s =
      std::hypot(latency_of_mean * mean_s, latency_of_doubt_from(counted.size()) * doubt_s);
  found.is_shown = *std::max_element(evidence.begin(), evidence.end()) >= significant;
  return found;
}

} // namespace dyncal::analysis
