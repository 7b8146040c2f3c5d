// How probable a sum of squares is when the model is right: the chi-squared distribution.
//
//   Q(chi^2, nu) = Gamma(nu / 2, chi^2 / 2) / Gamma(nu / 2)      that chance gives at least chi^2
//
// 1 for no degrees of freedom or chi^2 <= 0; never below the smallest double. Relative error below
// 1e-10 down to 1e-300. Plain function, any thread.
#pragma once

namespace dyncal::analysis {

[[nodiscard]] double chi_squared_probability(double chi_squared, double degrees_of_freedom);

} // namespace dyncal::analysis
