#include "analysis/response/conformity.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {
namespace {

// Within the limits, moved inwards by `w`.
bool is_within(double value, const ToleranceLimits& limits, double w) {
  constexpr double rounding = 1e-9;
  const auto dust = [](double limit) {
    return std::isfinite(limit) ? rounding * std::abs(limit) : 0.0;
  };
  return value >= limits.lower + w - dust(limits.lower) &&
         value <= limits.upper - w + dust(limits.upper);
}

ConformityStatement statement_of(double value, const ToleranceLimits& limits, DecisionRule rule,
                                 double w) {
  if (is_within(value, limits, w)) {
    return ConformityStatement::pass;
  }
  if (rule != DecisionRule::guard_band_non_binary) {
    return ConformityStatement::fail;
  }
  if (is_within(value, limits, 0.0)) {
    return ConformityStatement::conditional_pass;
  }
  return is_within(value, limits, -w) ? ConformityStatement::conditional_fail
                                      : ConformityStatement::fail;
}

double probability_within(double value, const CombinedUncertainty& of_value,
                          const ToleranceLimits& limits) {
  const double scale = of_value.expanded() / coverage_factor(of_value.degrees_of_freedom);
  const auto below = [&](double limit) {
    if (std::isinf(limit)) {
      return limit > 0.0 ? 1.0 : 0.0;
    }
    return student_probability((limit - value) / scale, of_value.degrees_of_freedom);
  };
  return std::clamp(below(limits.upper) - below(limits.lower), 0.0, 1.0);
}

} // namespace

std::string_view to_string(DecisionRule rule) {
  switch (rule) {
  case DecisionRule::simple_acceptance:
    return "simple-acceptance";
  case DecisionRule::guard_band:
    return "guard-band";
  case DecisionRule::guard_band_non_binary:
    return "guard-band-non-binary";
  }
  return "unknown";
}

std::string_view to_string(ConformityStatement statement) {
  switch (statement) {
  case ConformityStatement::pass:
    return "pass";
  case ConformityStatement::conditional_pass:
    return "conditional pass";
  case ConformityStatement::conditional_fail:
    return "conditional fail";
  case ConformityStatement::undecided:
    return "undecided";
  case ConformityStatement::fail:
    return "fail";
  }
  return "unknown";
}

Expected<Conformity> decide_conformity(double value, const CombinedUncertainty& of_value,
                                       const ToleranceLimits& limits, DecisionRule rule,
                                       double guard_factor) {
  const double expanded = of_value.expanded();
  if (!std::isfinite(value) || !std::isfinite(expanded) || !(expanded > 0.0) ||
      !(of_value.degrees_of_freedom > 0.0)) {
    return fail(ErrorCode::invalid_argument, "a decision needs a value and its U");
  }
  if (!(limits.lower < limits.upper) || !(guard_factor >= 0.0)) {
    return fail(ErrorCode::invalid_argument, "the lower limit must be below the upper one");
  }
  const double w = rule == DecisionRule::simple_acceptance ? 0.0 : guard_factor * expanded;
  return Conformity{statement_of(value, limits, rule, w),
                    probability_within(value, of_value, limits), w};
}

} // namespace dyncal::analysis
