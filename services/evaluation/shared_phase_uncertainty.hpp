// What the phases of all frequencies have in common, and what each has beyond it, from the budgets
// of their steps: what the regression of the group delay needs to know.
//
//   u_i^2 = w_i^2 d^2 + p^2 + beyond_i^2        for every row that repeats (Contribution::repeats)
//
// A row that is a delay (common_delay) counts as one delay d as far as all frequencies have it, the
// least of u_i / w_i; one of the reference as a delay and a phase p, by the line through u^2 over
// w^2 that lies nowhere above it. What a frequency has beyond that counts there by itself, as do
// the other rows that do not average. A row that a frequency lacks is 0 there. Plain function, any
// thread.
#pragma once

#include <span>
#include <vector>

#include "analysis/response/group_delay.hpp"
#include "analysis/uncertainty/contribution.hpp"

namespace dyncal::inline evaluation {

struct BudgetAtFrequency {
  double frequency_hz = 0.0;
  std::vector<analysis::Contribution> budget;
};

struct SharedPhaseUncertainty {
  analysis::CommonPhaseUncertainty common;
  std::vector<double> beyond_rad; // of each frequency
};

[[nodiscard]] SharedPhaseUncertainty
shared_phase_uncertainty(std::span<const BudgetAtFrequency> frequencies);

} // namespace dyncal::inline evaluation
