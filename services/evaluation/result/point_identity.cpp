#include "services/evaluation/result/point_identity.hpp"

#include <fmt/core.h>

namespace dyncal::inline evaluation {

PointIdentity identity_of(const StepResult& result) {
  PointIdentity point = mean_identity_of(result);
  point.repetition = result.repetition;
  point.attempt = result.attempt;
  return point;
}

PointIdentity identity_of(const TransferFunction& function, const FrequencyPoint& point) {
  return {.channel = function.channel,
          .frequency_hz = point.frequency_hz,
          .level_m_s2 = point.level_m_s2,
          .axis = function.excited_axis};
}

PointIdentity mean_identity_of(const StepResult& result) {
  return {.channel = result.channel,
          .frequency_hz = result.frequency_hz,
          .level_m_s2 = result.level_m_s2,
          .axis = result.excited_axis};
}

PointDifferences differences_of(const std::vector<PointIdentity>& points) {
  return {.levels = have_several_levels(points),
          .axes = std::any_of(points.begin(), points.end(), [&](const PointIdentity& one) {
            return one.axis != points.front().axis;
          })};
}

std::string place_text(const PointIdentity& point, PointDifferences shown) {
  std::string text = fmt::format("{} Hz", point.frequency_hz);
  if (shown.levels && point.level_m_s2 != 0.0) {
    text += fmt::format(", {} m/s^2", point.level_m_s2);
  }
  if (shown.axes && !point.axis.empty()) {
    text += ", axis " + point.axis;
  }
  if (point.repetition != 0) {
    text += fmt::format(", repetition {}", point.repetition);
  }
  if (point.attempt > 1) {
    text += fmt::format(", attempt {}", point.attempt);
  }
  return text;
}

std::string to_string(const PointIdentity& point, PointDifferences shown) {
  return fmt::format("{} at {}", point.channel, place_text(point, shown));
}

} // namespace dyncal::inline evaluation
