#include "services/views/report/result_file.hpp"

#include <cmath>

namespace dyncal::inline views {
namespace {

double known_level(double level_m_s2) {
  return std::isnan(level_m_s2) ? 0.0 : level_m_s2;
}

// With the U that was stated, whatever its u.
analysis::CombinedUncertainty combined(const ExpandedUncertainty& stated) {
  return {stated.expanded / stated.k, stated.nu_eff, stated.k};
}

bool has_value(double magnitude, double phase_rad) {
  return !std::isnan(magnitude) && !std::isnan(phase_rad);
}

} // namespace

PointIdentity identity_of(const StoredValue& value) {
  return {.channel = value.channel,
          .frequency_hz = value.frequency_hz,
          .level_m_s2 = known_level(value.level_m_s2),
          .axis = value.excited_axis};
}

analysis::ComparedResult comparable(const StoredValue& value) {
  return {value.magnitude, combined(value.of_magnitude), value.phase_rad, combined(value.of_phase)};
}

ResultPoints means_of(const StoredResult& result) {
  ResultPoints points;
  for (const StoredValue& value : result.values) {
    if (has_value(value.magnitude, value.phase_rad)) {
      points.emplace(identity_of(value), ResultPoint{value.unit, comparable(value)});
    }
  }
  return points;
}

ResultPoints repetitions_of(const StoredResult& result) {
  ResultPoints points;
  for (const StoredPoint& one : result.points) {
    if (!one.valid || !has_value(one.magnitude, one.phase_rad)) {
      continue;
    }
    PointIdentity identity = identity_of(one);
    identity.level_m_s2 = known_level(identity.level_m_s2);
    identity.attempt = 0;
    points.emplace(std::move(identity), ResultPoint{one.unit,
                                                    {one.magnitude, combined(one.of_magnitude),
                                                     one.phase_rad, combined(one.of_phase)},
                                                    one.attempt});
  }
  return points;
}

} // namespace dyncal::inline views
