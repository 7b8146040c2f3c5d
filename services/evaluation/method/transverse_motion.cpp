#include "services/evaluation/method/transverse_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::inline evaluation {
namespace {

// Of a phase that may be anything.
constexpr double largest_u_phase_rad = std::numbers::pi / std::numbers::sqrt3;

std::string_view source_of(const StepResult& result) {
  return std::string_view(result.channel).substr(0, result.channel.find('/'));
}

bool is_across(const Recipe& recipe, const StepResult& result) {
  return lies_across(axis_of(result.channel, recipe.channel_axes), result.excited_axis);
}

// The largest of those that lie along the excited axis beside it; 0: there is none.
double along(const Recipe& recipe, const std::vector<StepResult>& results,
             const StepResult& across) {
  double largest = 0.0;
  for (const StepResult& one : results) {
    const std::string axis = axis_of(one.channel, recipe.channel_axes);
    if (one.valid && one.unit == across.unit && source_of(one) == source_of(across) &&
        !axis.empty() && !is_across(recipe, one)) {
      largest = std::max(largest, one.magnitude);
    }
  }
  return largest;
}

} // namespace

std::vector<bool> add_transverse_motion(const Recipe& recipe, std::vector<StepResult>& results) {
  std::vector<bool> has_got(results.size(), false);
  for (std::size_t i = 0; i < results.size(); ++i) {
    StepResult& result = results[i];
    if (!result.valid || !is_across(recipe, result)) {
      continue;
    }
    const auto ratio = ratio_at(recipe.transverse_motion.points, result.frequency_hz);
    const double sensitivity = along(recipe, results, result);
    if (!ratio || !(sensitivity > 0.0) || !(result.magnitude > 0.0)) {
      continue;
    }
    const double u_rel = *ratio * sensitivity / (result.magnitude * std::numbers::sqrt3);
    analysis::Contribution row{.kind = analysis::ContributionKind::transverse_motion,
                               .distribution = analysis::Distribution::rectangular};
    row.u_magnitude_rel = u_rel;
    row.u_phase_rad = std::min(u_rel, largest_u_phase_rad);
    result.u_magnitude = std::hypot(result.u_magnitude, u_rel * result.magnitude);
    result.u_phase_rad = std::hypot(result.u_phase_rad, row.u_phase_rad);
    result.budget.push_back(std::move(row));
    has_got[i] = true;
  }
  return has_got;
}

} // namespace dyncal::inline evaluation
