#include "analysis/base/chi_squared_limit.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {

double chi_squared_limit(double degrees_of_freedom, double normal_quantile) {
  const double spread = 2.0 / (9.0 * degrees_of_freedom);
  return std::pow(std::max(0.0, 1.0 - spread + normal_quantile * std::sqrt(spread)), 3.0);
}

} // namespace dyncal::analysis
