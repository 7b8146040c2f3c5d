// Chi-squared over its degrees of freedom that is exceeded with the chance that a normal deviate
// exceeds `normal_quantile` (Wilson and Hilferty); a negative quantile gives the lower limit. Any
// thread.
#pragma once

namespace dyncal::analysis {

inline constexpr double once_in_a_thousand = 3.0902; // normal quantile

[[nodiscard]] double chi_squared_limit(double degrees_of_freedom, double normal_quantile);

} // namespace dyncal::analysis
