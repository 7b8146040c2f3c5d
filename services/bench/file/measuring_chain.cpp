#include "services/bench/file/measuring_chain.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/core.h>

namespace dyncal::inline bench {
namespace {

using analysis::ReferenceCalibrationPoint;
using analysis::ReferenceContribution;
using analysis::ReferenceResponse;
using Points = std::vector<ReferenceCalibrationPoint>;

constexpr const char* between_points = "interpolation"; // of reference_response_at()

Expected<void> check_fit(const std::string& what, const std::string& of, const std::string& needed,
                         const std::string& by) {
  return what == needed ? Expected<void>()
                        : fail(ErrorCode::bad_argument,
                               fmt::format("{} is in {}, {} in {}", of, what, by, needed));
}

Expected<void> check_units(const MeasuringChain& chain) {
  const SensitivityUnit& transducer = chain.transducer.unit;
  const SensitivityUnit& channel = chain.channel_unit;
  DYNCAL_TRY(check_fit(transducer.input, "what the transducer measures", channel.input,
                       "that of the channel"));
  if (!chain.amplifier) {
    return check_fit(transducer.output, "the output of the transducer", channel.output,
                     "what the channel measures (a charge needs the table [amplifier])");
  }
  DYNCAL_TRY(check_fit(transducer.output, "the output of the transducer",
                       chain.amplifier->unit.input, "the input of the amplifier"));
  return check_fit(chain.amplifier->unit.output, "the output of the amplifier", channel.output,
                   "what the channel measures");
}

// The frequencies of both.
std::set<double> frequencies_of(const MeasuringChain& chain) {
  std::set<double> frequencies;
  for (const Points* points :
       {&chain.transducer.points, chain.amplifier ? &chain.amplifier->points : nullptr}) {
    for (const ReferenceCalibrationPoint& point : points != nullptr ? *points : Points()) {
      frequencies.insert(point.frequency_hz);
    }
  }
  return frequencies;
}

std::set<double> levels_of(const Points& points) {
  std::set<double> levels;
  for (const ReferenceCalibrationPoint& point : points) {
    levels.insert(point.level_m_s2);
  }
  return levels;
}

// Adds the contributions of one of the two to a point of the chain; what it misses between its own
// points is added up in `between`.
void add(const ReferenceResponse& response, const std::string& prefix,
         ReferenceCalibrationPoint& point, ReferenceContribution& between) {
  point.magnitude *= response.magnitude;
  point.phase_rad += response.phase_rad;
  for (ReferenceContribution one : response.contributions) {
    if (one.name == between_points) {
      between.u_magnitude_rel = std::hypot(between.u_magnitude_rel, one.u_magnitude_rel);
      between.u_phase_rad = std::hypot(between.u_phase_rad, one.u_phase_rad);
      continue;
    }
    one.name = prefix.empty() || one.name.empty() ? prefix + one.name : prefix + " " + one.name;
    point.contributions.push_back(std::move(one));
  }
}

std::optional<ReferenceCalibrationPoint> point_at(const MeasuringChain& chain, double frequency_hz,
                                                  double level_m_s2) {
  const auto transducer =
      analysis::reference_response_at(chain.transducer.points, frequency_hz, level_m_s2);
  if (!transducer) {
    return std::nullopt;
  }
  const double factor =
      chain.transducer.unit.factor / (chain.channel_sensitivity * chain.channel_unit.factor);
  ReferenceCalibrationPoint point{
      .frequency_hz = frequency_hz, .level_m_s2 = level_m_s2, .magnitude = factor};
  ReferenceContribution between{.name = "frequencies of the certificates"};
  add(*transducer, "", point, between);
  if (chain.amplifier) {
    const auto amplifier =
        analysis::reference_response_at(chain.amplifier->points, frequency_hz, level_m_s2);
    if (!amplifier) {
      return std::nullopt;
    }
    point.magnitude *= chain.amplifier->unit.factor;
    add(*amplifier, "amplifier", point, between);
    point.contributions.push_back(between);
  }
  return point;
}

} // namespace

Expected<Points> response_of(const MeasuringChain& chain) {
  DYNCAL_TRY(check_units(chain));
  Points points;
  for (const double level_m_s2 : levels_of(chain.transducer.points)) {
    for (const double frequency_hz : frequencies_of(chain)) {
      if (auto point = point_at(chain, frequency_hz, level_m_s2)) {
        points.push_back(std::move(*point));
      }
    }
  }
  if (points.empty()) {
    return fail(ErrorCode::bad_argument,
                "the tables of transducer and amplifier have no frequency in common");
  }
  constexpr double least = 0.5;
  constexpr double most = 2.0;
  for (const ReferenceCalibrationPoint& point : points) {
    if (point.magnitude < least || point.magnitude > most) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("at {} Hz the channel would read {:.4g} times what is: units, the "
                              "gain of the amplifier or the channel's sensitivity are not right",
                              point.frequency_hz, point.magnitude));
    }
  }
  return points;
}

} // namespace dyncal::inline bench
