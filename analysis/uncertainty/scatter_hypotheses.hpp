// What scatter from run to run is the same in at all frequencies of a session, and how likely each
// size of it makes what was measured.
//
// A hypothesis has a unit g_f for each frequency: the noise, a constant, or the frequency (scatter
// that is a time). Its scatter is tau_f = g_f tau at frequencies that are independent of each
// other, tau alike within 30 % and one frequency in ten unlike the others; or it is that of whole
// sweeps, tau_c, beside that of single runs, tau_d (sweep_scatter.hpp). Likelihoods are those of
// the contrasts, which do not depend on the mean (restricted). Any thread.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "analysis/uncertainty/random_effects.hpp"
#include "analysis/uncertainty/scatter_grid.hpp"
#include "analysis/uncertainty/sweep_scatter.hpp"

namespace dyncal::analysis {

inline constexpr double unlike_others = 0.1; // probability that a frequency scatters as no other

// How far tau differs between frequencies: five points of a log-normal distribution.
struct Likeness {
  double factor, weight;
};
[[nodiscard]] const std::array<Likeness, 5>& likeness();

// Root mean square of what its runs state.
[[nodiscard]] double noise_of(const RepeatedQuantity& quantity);
[[nodiscard]] bool shows_scatter(const RepeatedQuantity& quantity);

[[nodiscard]] double log_likelihood(const RepeatedQuantity& quantity, double tau);

struct ScatterHypothesis {
  std::vector<double> unit;              // g_f
  std::vector<ScatterGrid> log_evidence; // of each frequency for tau, independent of the others
  ScatterGrid log_sum{};                 // of all of them
  std::vector<ScatterGrid> log_steps;    // of each frequency for tau_d
  ScatterGrid log_steps_sum{};
  std::vector<SweepScatter> sweeps; // at each tau_d; empty where nothing can be told of sweeps
};

[[nodiscard]] std::vector<ScatterHypothesis>
scatter_hypotheses(std::span<const RepeatedQuantity> quantities);

} // namespace dyncal::analysis
