#include "services/evaluation/method/level_check.hpp"

#include <cmath>

#include <fmt/core.h>

#include "services/contract/unit.hpp"

namespace dyncal::inline evaluation {

std::optional<Flag> find_level_deviation(const RecipeStep& step, double level_deviation_rel,
                                         const analysis::ChannelFit& reference,
                                         const std::string& reference_unit) {
  if (!is_acceleration(reference_unit) || !(step.level_m_s2 > 0.0)) {
    return std::nullopt;
  }
  const double measured_m_s2 = reference.fit.amplitude();
  if (std::abs(measured_m_s2 / step.level_m_s2 - 1.0) <= level_deviation_rel) {
    return std::nullopt;
  }
  return flag_with_reason(
      ResultFlag::level_off_plan,
      fmt::format("{:.4g} m/s^2 in place of {:.4g} m/s^2", measured_m_s2, step.level_m_s2));
}

} // namespace dyncal::inline evaluation
