#include "services/views/report/run_statements.hpp"

#include <cmath>
#include <numbers>

namespace dyncal::inline views {

double LoggedCondition::expanded_over_run() const {
  const double u_of_range = 0.5 * (maximum - minimum) / std::numbers::sqrt3; // rectangular
  return std::hypot(expanded, 2.0 * u_of_range);
}

} // namespace dyncal::inline views
