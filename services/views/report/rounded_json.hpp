// Texts of values and their uncertainties for the page, which rounds nothing itself: made by
// services/base/rounding.hpp, {"value": "0.97718", "u": "0.00093"}; null: not a number. A derived
// number, rounded by its U, has "U" and "k" as well. Plain functions, any thread.
#pragma once

#include <nlohmann/json.hpp>

#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::inline views {

[[nodiscard]] nlohmann::ordered_json rounded_json(double value, double u);
[[nodiscard]] nlohmann::ordered_json rounded_json(double value,
                                                  const analysis::CombinedUncertainty& of_value);
// Of one value of a transfer function: "magnitude", "phase_rad" and "phase_deg".
[[nodiscard]] nlohmann::ordered_json rounded_json(double magnitude, double u_magnitude,
                                                  double phase_rad, double u_phase_rad);

} // namespace dyncal::inline views
