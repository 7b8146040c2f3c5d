// What a run was made with, for result files: sources, roles of channels, corrections, the planned
// steps with what was measured of the excitation, and the bench file. Plain functions, any thread.
#pragma once

#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::services {

[[nodiscard]] nlohmann::ordered_json sources_json(const RunOutcome& outcome);
[[nodiscard]] nlohmann::ordered_json roles_json(const Recipe& recipe);
// As numbers, as the recipe has them for all steps.
[[nodiscard]] nlohmann::ordered_json corrections_json(const Recipe& recipe,
                                                      const std::optional<AdcFile>& adc_file);
// What they do to arg H at one frequency.
[[nodiscard]] nlohmann::ordered_json applied_corrections_json(const Recipe& recipe,
                                                              const RecipeStep& step);

// The sine fitted to one channel: coefficients, covariance, residuals, and the channel's role.
[[nodiscard]] nlohmann::ordered_json fit_json(const RunOutcome& outcome,
                                              const analysis::ChannelFit& fit);

// One entry a planned step: what was planned, what reference and sync show of it, corrections.
[[nodiscard]] nlohmann::ordered_json steps_json(const RunOutcome& outcome);

// The fit of the reference in a result, and whether it is an acceleration in m/s^2.
struct MeasuredExcitation {
  const analysis::ChannelFit* reference = nullptr;
  bool is_acceleration = false;
};
[[nodiscard]] std::optional<MeasuredExcitation> measured_excitation(const RunOutcome& outcome,
                                                                    const StepResult& result);

} // namespace dyncal::services
