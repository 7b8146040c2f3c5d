#include "services/evaluation/method/unstated_uncertainty.hpp"

#include <algorithm>

namespace dyncal::inline evaluation {

namespace {

// Of the reference: beside its calibration, or by it.
bool is_stated(const Recipe& recipe, double analysis::SystematicUncertainty::*beside,
               double analysis::ReferenceContribution::*of_contribution) {
  const auto is_above_0 = [&](const analysis::ReferenceContribution& one) {
    return one.*of_contribution > 0.0;
  };
  return recipe.systematic.*beside > 0.0 ||
         std::ranges::any_of(recipe.reference_calibration,
                             [&](const analysis::ReferenceCalibrationPoint& point) {
                               return std::ranges::any_of(point.contributions, is_above_0);
                             });
}

} // namespace

std::vector<Flag> flags_of_unstated(const Recipe& recipe) {
  std::vector<Flag> flags;
  const bool has_table = !recipe.reference_table.empty(); // no step of it is without u
  if (has_table) {
    // Delays between its channels are in the u of its phase.
  } else if (!is_stated(recipe, &analysis::SystematicUncertainty::reference_magnitude_rel,
                        &analysis::ReferenceContribution::u_magnitude_rel) ||
             !is_stated(recipe, &analysis::SystematicUncertainty::reference_phase_rad,
                        &analysis::ReferenceContribution::u_phase_rad)) {
    flags.push_back(make_flag(ResultFlag::reference_uncertainty_not_stated));
  }
  if (recipe.method() == EvaluationMethod::sample_timestamping && recipe.adc_calibration.empty() &&
      !(recipe.u_adc_delay_s > 0.0)) {
    flags.push_back(make_flag(ResultFlag::adc_not_calibrated));
  }
  if (recipe.method() == EvaluationMethod::series_timestamping &&
      !(recipe.series.u_dso_delay_s > 0.0)) {
    flags.push_back(make_flag(ResultFlag::trigger_delay_not_stated));
  }
  // Absolute time has a flag of its own, for there the key holds the clock as well.
  if (!has_table && recipe.method() != EvaluationMethod::absolute_time &&
      !(recipe.systematic.acs_delay_s > 0.0)) {
    flags.push_back(make_flag(ResultFlag::acs_delay_not_stated));
  }
  return flags;
}

} // namespace dyncal::inline evaluation
