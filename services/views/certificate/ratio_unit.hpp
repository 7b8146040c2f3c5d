// The unit of a transfer function in D-SI: results carry D-SI, or the quotient of two short forms
// ("(rad/s)/(m/s^2)") where sensor and reference are of different kinds. Any thread.
#pragma once

#include <optional>
#include <string>

namespace dyncal::inline views {

// \radian\second\tothe{-1}\metre\tothe{-1}\second\tothe{2}; nothing for what is not a unit.
[[nodiscard]] std::optional<std::string> ratio_in_d_si(const std::string& unit);

} // namespace dyncal::inline views
