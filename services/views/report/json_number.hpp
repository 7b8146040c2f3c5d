// Numbers of result files: JSON cannot represent NaN or infinity, so they are null. Any thread.
#pragma once

#include <cmath>

#include <nlohmann/json.hpp>

namespace dyncal::inline views {

[[nodiscard]] inline nlohmann::ordered_json json_number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

} // namespace dyncal::inline views
