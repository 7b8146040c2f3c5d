// Amplitude linearity as the table of `dyncal linearity` and as JSON: deviations in % and degrees,
// each with its U, rounded by that U; JSON has every digit, in SI units. Any thread.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "services/views/linearity/amplitude_linearity.hpp"

namespace dyncal::inline views {

[[nodiscard]] std::string linearity_table(const AmplitudeLinearity& linearity);
[[nodiscard]] nlohmann::ordered_json linearity_json(const AmplitudeLinearity& linearity);

} // namespace dyncal::inline views
