#include "analysis/instrument/reference_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <sstream>

#include "analysis/base/phasor.hpp"
#include "analysis/instrument/curve_between_points.hpp"

namespace dyncal::analysis {
namespace {

constexpr const char* interpolation = "interpolation";

using Curve = std::vector<ReferenceCalibrationPoint>; // of one level, rising in frequency

std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

bool is_valid(const ReferenceCalibrationPoint& point) {
  return std::isfinite(point.frequency_hz) && point.frequency_hz > 0.0 &&
         std::isfinite(point.level_m_s2) && std::isfinite(point.magnitude) &&
         point.magnitude > 0.0 && std::isfinite(point.phase_rad) &&
         std::all_of(point.contributions.begin(), point.contributions.end(),
                     [](const ReferenceContribution& one) {
                       return one.u_magnitude_rel >= 0.0 && std::isfinite(one.u_magnitude_rel) &&
                              one.u_phase_rad >= 0.0 && std::isfinite(one.u_phase_rad) &&
                              one.degrees_of_freedom > 0.0;
                     });
}

bool have_same_contributions(const ReferenceCalibrationPoint& a,
                             const ReferenceCalibrationPoint& b) {
  return std::equal(a.contributions.begin(), a.contributions.end(), b.contributions.begin(),
                    b.contributions.end(),
                    [](const ReferenceContribution& one, const ReferenceContribution& other) {
                      return one.name == other.name;
                    });
}

Expected<std::map<double, Curve>>
curves_of_levels(std::span<const ReferenceCalibrationPoint> points) {
  if (points.empty()) {
    return fail(ErrorCode::invalid_argument, "the calibration of the reference has no points");
  }
  std::map<double, Curve> curves;
  for (const ReferenceCalibrationPoint& point : points) {
    if (!is_valid(point) || !have_same_contributions(point, points.front())) {
      return fail(ErrorCode::invalid_argument,
                  "the calibration of the reference has a point at " + number(point.frequency_hz) +
                      " Hz whose numbers are not valid, or whose contributions are not those of "
                      "the others");
    }
    curves[point.level_m_s2].push_back(point);
  }
  for (auto& [level, curve] : curves) {
    std::sort(curve.begin(), curve.end(),
              [](const auto& a, const auto& b) { return a.frequency_hz < b.frequency_hz; });
    const auto twice =
        std::adjacent_find(curve.begin(), curve.end(), [](const auto& a, const auto& b) {
          return a.frequency_hz == b.frequency_hz;
        });
    if (twice != curve.end()) {
      return fail(ErrorCode::invalid_argument, "the calibration of the reference has " +
                                                   number(twice->frequency_hz) + " Hz twice");
    }
  }
  return curves;
}

ReferenceResponse response_of(const ReferenceCalibrationPoint& point) {
  return {point.magnitude, wrap_phase(point.phase_rad), point.contributions};
}

// The more of `b`, the nearer `weight` is to 1.
ReferenceResponse between(const ReferenceResponse& a, const ReferenceResponse& b, double weight) {
  const auto mixed = [&](double left, double right) { return left + weight * (right - left); };
  const double turned_rad = wrap_phase(b.phase_rad - a.phase_rad);
  ReferenceResponse result{mixed(a.magnitude, b.magnitude),
                           wrap_phase(a.phase_rad + weight * turned_rad), a.contributions};
  for (std::size_t i = 0; i < result.contributions.size(); ++i) {
    ReferenceContribution& one = result.contributions[i];
    const ReferenceContribution& other = b.contributions[i];
    one.u_magnitude_rel = mixed(one.u_magnitude_rel, other.u_magnitude_rel);
    one.u_phase_rad = mixed(one.u_phase_rad, other.u_phase_rad);
    one.degrees_of_freedom = std::min(one.degrees_of_freedom, other.degrees_of_freedom);
  }
  return result;
}

struct Table { // of one level
  std::vector<double> frequencies_hz, magnitudes;
  UnwrappedPhases phases;
};

Table table_of(const Curve& curve) {
  Table table;
  std::vector<double> phases_rad;
  for (const ReferenceCalibrationPoint& point : curve) {
    table.frequencies_hz.push_back(point.frequency_hz);
    table.magnitudes.push_back(point.magnitude);
    phases_rad.push_back(point.phase_rad);
  }
  table.phases = unwrap_over_frequency(table.frequencies_hz, phases_rad);
  return table;
}

ReferenceResponse between_points(const Curve& curve, std::size_t i, double frequency_hz) {
  const Table table = table_of(curve);
  const CurveValue magnitude =
      curve_between_points(table.frequencies_hz, table.magnitudes, i, frequency_hz);
  const CurveValue phase =
      curve_between_points(table.frequencies_hz, table.phases.phases_rad, i, frequency_hz);
  const double missed_phase =
      phase.missed + (table.phases.ambiguous[i] ? ambiguous_phase_rad(phase.weight) : 0.0);
  ReferenceResponse response = between(response_of(curve[i]), response_of(curve[i + 1]),
                                       (frequency_hz - curve[i].frequency_hz) /
                                           (curve[i + 1].frequency_hz - curve[i].frequency_hz));
  response.magnitude = magnitude.value;
  response.phase_rad = wrap_phase(phase.value);
  response.contributions.push_back(
      {.name = interpolation,
       .distribution = Distribution::rectangular,
       .u_magnitude_rel = magnitude.missed / std::numbers::sqrt3 / response.magnitude,
       .u_phase_rad = missed_phase / std::numbers::sqrt3});
  return response;
}

Expected<ReferenceResponse> response_on(const Curve& curve, double frequency_hz) {
  const auto above =
      std::lower_bound(curve.begin(), curve.end(), frequency_hz,
                       [](const auto& point, double hz) { return point.frequency_hz < hz; });
  if (above != curve.end() && above->frequency_hz == frequency_hz) {
    ReferenceResponse exact = response_of(*above);
    exact.contributions.push_back(
        {.name = interpolation, .distribution = Distribution::rectangular});
    return exact;
  }
  if (above == curve.begin() || above == curve.end()) {
    return fail(ErrorCode::out_of_calibration, "the reference was calibrated from " +
                                                   number(curve.front().frequency_hz) + " to " +
                                                   number(curve.back().frequency_hz) +
                                                   " Hz, not at " + number(frequency_hz) + " Hz");
  }
  return between_points(curve, static_cast<std::size_t>(above - curve.begin()) - 1, frequency_hz);
}

} // namespace

Expected<ReferenceResponse> reference_response_at(std::span<const ReferenceCalibrationPoint> points,
                                                  double frequency_hz, double level_m_s2) {
  DYNCAL_TRY(const auto curves, curves_of_levels(points));
  if (curves.size() == 1) {
    return response_on(curves.begin()->second, frequency_hz);
  }
  const auto above = curves.lower_bound(level_m_s2);
  if (above == curves.end() || (above == curves.begin() && above->first > level_m_s2)) {
    return fail(ErrorCode::out_of_calibration,
                "the reference was calibrated from " + number(curves.begin()->first) + " to " +
                    number(curves.rbegin()->first) + " m/s^2, not at " + number(level_m_s2) +
                    " m/s^2");
  }
  const auto upper = response_on(above->second, frequency_hz);
  if (!upper || above->first == level_m_s2) {
    return upper;
  }
  const auto below = std::prev(above);
  const auto lower = response_on(below->second, frequency_hz);
  if (!lower) {
    return lower;
  }
  return between(*lower, *upper, (level_m_s2 - below->first) / (above->first - below->first));
}

} // namespace dyncal::analysis
