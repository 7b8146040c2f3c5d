#include "services/contract/transverse_motion.hpp"

#include <algorithm>
#include <limits>

namespace dyncal::inline contract {

std::optional<double> ratio_at(std::span<const TransverseMotionPoint> points, double frequency_hz) {
  std::optional<double> below;
  std::optional<double> above;
  double below_hz = 0.0;
  double above_hz = std::numeric_limits<double>::infinity();
  for (const TransverseMotionPoint& point : points) {
    if (point.frequency_hz == 0.0) {
      return point.ratio;
    }
    if (point.frequency_hz <= frequency_hz && point.frequency_hz >= below_hz) {
      below_hz = point.frequency_hz;
      below = point.ratio;
    }
    if (point.frequency_hz >= frequency_hz && point.frequency_hz <= above_hz) {
      above_hz = point.frequency_hz;
      above = point.ratio;
    }
  }
  return below && above ? std::optional(std::max(*below, *above)) : std::nullopt;
}

} // namespace dyncal::inline contract
