// What closures look at: the results of one channel in the order in which they were excited, and
// what was made of them; and how far chance may take a comparison.
//
// Every kind of closure may be open by chance in one run of 130 000 (clock_links in one of 16 000),
// so that all of them together are in at most one of 10 000, of 6000 where both clocks have UTC;
// kinds share that among their comparisons. Plain data and functions;
// any thread.
#pragma once

#include <complex>
#include <cstddef>
#include <string>
#include <vector>

#include "analysis/method/repetitions.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/closure.hpp"
#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"

namespace dyncal::inline evaluation {

inline constexpr double chance_of_closure = 1e-4 / 13.0;

// Standard uncertainties that one of `comparisons` exceeds by chance, of Student's distribution.
[[nodiscard]] double
limit_by_chance(std::size_t comparisons,
                double degrees_of_freedom = analysis::infinite_degrees_of_freedom);
// The same of chi-squared, over its degrees of freedom.
[[nodiscard]] double chi_squared_by_chance(std::size_t comparisons, double degrees_of_freedom);

struct ChannelRun {
  const Recipe& recipe;
  const TransferFunction& function;
  std::vector<const StepResult*> results; // valid, in the order of the plan
  std::string reference_unit;
  double nominal_rate_hz = 0.0; // of the channel's source; 0: not stated

  // At most of the frequencies the channel follows the excitation: its value is ten times its u.
  [[nodiscard]] bool moves() const;
  // "80 Hz"; in a run of several levels "80 Hz, 2 m/s^2".
  [[nodiscard]] std::string place_of(const StepResult& result) const;
};

// "dau" of "dau/x".
[[nodiscard]] std::string source_of(const std::string& channel);

// What another channel has in the step and repetition of `result`; nullptr: nothing.
[[nodiscard]] const StepResult* in_same_step(const StepResult& result, const ChannelRun& other);

struct PointRepetitions { // of one frequency and level
  std::vector<const StepResult*> results;
  std::vector<analysis::Repetition> values;
};
// All points, those that were measured once as well.
[[nodiscard]] std::vector<PointRepetitions> points_of(const ChannelRun& run);
[[nodiscard]] analysis::Repetition repetition_of(const StepResult& result);

[[nodiscard]] Closure not_possible(ClosureKind kind, std::string subject, std::string why);

struct Comparison {
  double value = 0.0;
  double u = 0.0;
  double limit = 0.0; // closes where |value| is not above it
  std::string unit;
};
[[nodiscard]] Closure judged(ClosureKind kind, std::string subject, const Comparison& comparison,
                             std::string sentence);

} // namespace dyncal::inline evaluation
