// What is known of the error of a mean, and the interval that follows.
//
// A mixture of normal distributions, one for each scatter from run to run that may be
// (random_effects.hpp); or, where no noise is known, Student's t of the observed scatter.
//
// U is half the 95.45 % interval of that and of what all runs have in common, normal and known;
// nu_eff is that of Student's t whose 68.27 % and 95.45 % intervals have the same quotient, k is
// its factor, and u = U / k. Units: those of the values. Any thread.
#pragma once

#include <vector>

#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::analysis {

struct MeanError {
  struct Part {
    double variance = 0.0;
    double weight = 0.0; // all parts: 1
  };
  std::vector<Part> parts;
  UncertaintyPart student{};
};

[[nodiscard]] CombinedUncertainty combine(const MeanError& error, double u_common);

} // namespace dyncal::analysis
