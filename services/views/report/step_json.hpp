// What result files and the page say of a value in the same words: the value, its expanded
// uncertainty, its budget, and the signals behind it. Any thread.
#pragma once

#include <nlohmann/json.hpp>

#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"
#include "services/views/report/expanded_uncertainty.hpp"

namespace dyncal::services {

// Beside u_magnitude and u_phase_rad: k, effective degrees of freedom (null: infinite) and U, and
// the coverage probability.
void add_expanded(const ExpandedUncertainty& magnitude, const ExpandedUncertainty& phase,
                  nlohmann::ordered_json& json);

// Of a step, without its expanded uncertainty.
[[nodiscard]] nlohmann::ordered_json value_json(const StepResult& result);
// Of a frequency over its repetitions, with it.
[[nodiscard]] nlohmann::ordered_json mean_json(const FrequencyPoint& point);
[[nodiscard]] nlohmann::ordered_json budget_json(const StepResult& result);
[[nodiscard]] nlohmann::ordered_json signals_json(const StepResult& result);

// An angle in degrees; null: not finite.
[[nodiscard]] nlohmann::ordered_json degrees(double angle_rad);

} // namespace dyncal::services
