// Does a value conform to a tolerance? The statements of ILAC-G8:09/2019, with the probability of
// conformity of JCGM 106:2012.
//
//   acceptance limits   lower + w .. upper - w,   w = guard_factor U; 0 by simple acceptance
//
//   rule                   pass               conditional pass   conditional fail     fail
//   simple acceptance      within tolerance                                           else
//   guard band             within acceptance                                          else
//   guard band non-binary  within acceptance  within tolerance   within w beyond it   else
//
// A value at a limit is within it, to 1e-9 of the limit: 1.05 is 5 % above 1, whatever the last bit
// says. A guard band of more than half the tolerance leaves nothing that could pass. Limits may be
// infinite. The probability is that of Student's t with the degrees of freedom of the value (normal
// where they are infinite) whose interval of 95.45 % is U. What cannot be decided is for callers to
// state as undecided; it never passes.
//
// Fails: invalid_argument (value not finite, U not positive, lower limit not below the upper one).
// Any thread.
#pragma once

#include <string_view>

#include "analysis/base/error.hpp"
#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::analysis {

enum class DecisionRule { simple_acceptance, guard_band, guard_band_non_binary };

// From the best to the worst that can be said of several values together.
enum class ConformityStatement { pass, conditional_pass, conditional_fail, undecided, fail };

// "simple-acceptance", "conditional pass"
[[nodiscard]] std::string_view to_string(DecisionRule rule);
[[nodiscard]] std::string_view to_string(ConformityStatement statement);

struct ToleranceLimits {
  double lower = 0.0;
  double upper = 0.0;
};

struct Conformity {
  ConformityStatement statement = ConformityStatement::undecided;
  double probability = 0.0; // that the true value is within the tolerance limits
  double guard_band = 0.0;  // w
};

[[nodiscard]] Expected<Conformity> decide_conformity(double value,
                                                     const CombinedUncertainty& of_value,
                                                     const ToleranceLimits& limits,
                                                     DecisionRule rule, double guard_factor = 1.0);

} // namespace dyncal::analysis
