#include "analysis/response/largest_transverse.hpp"

#include <cmath>
#include <numbers>

namespace dyncal::analysis {

LargestTransverse largest_transverse(const TransverseAnswer& first, const TransverseAnswer& second,
                                     double along) {
  const double a2 = std::norm(first.h);
  const double b2 = std::norm(second.h);
  const double both = std::real(first.h * std::conj(second.h));
  const double angle = 0.5 * std::atan2(2.0 * both, a2 - b2);
  const double square = 0.5 * (a2 + b2) + std::hypot(0.5 * (a2 - b2), both);
  return {.ratio = std::sqrt(square) / along,
          .u_ratio = std::hypot(std::cos(angle) * first.u, std::sin(angle) * second.u) / along,
          .angle_rad = angle < 0.0 ? angle + std::numbers::pi : angle};
}

} // namespace dyncal::analysis
