#include "services/records/store/unwrapped_phases.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "analysis/instrument/curve_between_points.hpp"

namespace dyncal::inline records {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;

using PhaseOverFrequency = std::map<double, double>;
using Channels = std::map<std::string, PhaseOverFrequency>;

bool has_phase(const StoredValue& point) {
  return std::isfinite(point.phase_rad) && std::isfinite(point.frequency_hz) &&
         point.frequency_hz > 0.0;
}

// Of one point a frequency.
PhaseOverFrequency unwrapped(const PhaseOverFrequency& phases) {
  std::vector<double> frequencies_hz;
  std::vector<double> phases_rad;
  for (const auto& [frequency_hz, phase_rad] : phases) {
    frequencies_hz.push_back(frequency_hz);
    phases_rad.push_back(phase_rad);
  }
  if (phases.size() > 1) {
    phases_rad = analysis::unwrap_over_frequency(frequencies_hz, phases_rad).phases_rad;
  }
  PhaseOverFrequency result;
  for (std::size_t i = 0; i < phases_rad.size(); ++i) {
    result[frequencies_hz[i]] = phases_rad[i];
  }
  return result;
}

// By whole turns, to `first`: those that it has not follow the others.
void move_to(const PhaseOverFrequency& first, PhaseOverFrequency& phases) {
  double sum_rad = 0.0;
  int count = 0;
  for (const auto& [frequency_hz, phase_rad] : phases) {
    if (const auto there = first.find(frequency_hz); there != first.end()) {
      sum_rad += there->second - phase_rad;
      ++count;
    }
  }
  const double turns = count > 0 ? std::round(sum_rad / count / turn) : 0.0;
  for (auto& [frequency_hz, phase_rad] : phases) {
    const auto there = first.find(frequency_hz);
    phase_rad +=
        turn * (there == first.end() ? turns : std::round((there->second - phase_rad) / turn));
  }
}

} // namespace

void unwrap_phases(std::vector<Calibration>& calibrations) {
  Channels first;
  for (Calibration& calibration : calibrations) {
    Channels channels;
    for (const StoredValue& point : calibration.points) {
      if (has_phase(point)) {
        channels[point.channel].emplace(point.frequency_hz, point.phase_rad);
      }
    }
    for (auto& [channel, phases] : channels) {
      phases = unwrapped(phases);
      move_to(first.emplace(channel, phases).first->second, phases);
    }
    for (StoredValue& point : calibration.points) {
      if (has_phase(point)) {
        const double near_rad = channels[point.channel][point.frequency_hz];
        point.unwrapped_phase_rad =
            point.phase_rad + turn * std::round((near_rad - point.phase_rad) / turn);
      }
    }
  }
}

} // namespace dyncal::inline records
