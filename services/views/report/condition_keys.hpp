// Quantities of the surroundings, as they are logged and as they are amended. Plain data.
#pragma once

#include <array>

namespace dyncal::inline views {

struct ConditionKeys {
  const char* quantity; // of a logged condition
  const char* unit;     // likewise
  const char* value;    // of laboratory file and amendment
  const char* expanded; // its U, likewise
};

inline constexpr std::array condition_keys{
    ConditionKeys{"temperature", "degC", "temperature_degc", "U_temperature_k"},
    ConditionKeys{"humidity", "%", "humidity_percent", "U_humidity_percent"},
    ConditionKeys{"pressure", "hPa", "pressure_hpa", "U_pressure_hpa"}};

} // namespace dyncal::inline views
