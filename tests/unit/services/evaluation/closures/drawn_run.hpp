// Results of a run drawn from a seed: a sensor with a delay, noise as its budget states, two clocks
// that are a few ppm apart, and in half of all draws a sensor that is mounted anew for every sweep.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "services/evaluation/closures/closures.hpp"

namespace dyncal::inline evaluation {

struct DrawnRun {
  Recipe recipe;
  std::vector<StepResult> results;

  // Of the first channel; `name`: all of that kind.
  [[nodiscard]] std::vector<Closure> closures() const;
  [[nodiscard]] std::vector<StepResult> flagged() const;
  // The same with what a fault does to the means.
  [[nodiscard]] std::vector<Closure>
  closures_after(const std::function<void(TransferFunction&)>& fault) const;
};

struct DrawnOptions {
  std::size_t channels = 1;
  EvaluationMethod method = EvaluationMethod::sample_timestamping;
  bool repeat_first = true;
  std::uint32_t repetitions = 3;
  std::size_t points = 6;
};

[[nodiscard]] DrawnRun draw_run(unsigned seed, const DrawnOptions& options = {});

} // namespace dyncal::inline evaluation
