// What the recipe of a run planned and corrected, as result files have it. Plain functions, any
// thread.
#pragma once

#include <string>
#include <vector>

#include "services/evaluation/result/run_outcome.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

[[nodiscard]] StoredRoles stored_roles(const Recipe& recipe);
[[nodiscard]] StoredCorrections stored_corrections(const Recipe& recipe,
                                                   const std::optional<AdcFile>& adc_file);
// What they do to H at the frequency of a step.
[[nodiscard]] std::vector<StoredCorrection> applied_corrections(const Recipe& recipe,
                                                                const RecipeStep& step);
// One entry a planned step.
[[nodiscard]] std::vector<StoredStep> stored_steps(const RunOutcome& outcome);
[[nodiscard]] StoredFit stored_fit(const RunOutcome& outcome, const analysis::ChannelFit& fit);

// What the reference measured of the excitation; its level only where it is in m/s^2.
void add_measured_excitation(const RunOutcome& outcome, StoredPoint& point);

} // namespace dyncal::inline views
