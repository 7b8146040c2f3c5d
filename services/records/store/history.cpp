#include "services/records/store/history.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "services/views/report/result_file.hpp"

namespace dyncal::inline records {
namespace {

bool is_usable(const StoredValue& point) {
  return std::isfinite(point.magnitude) && point.magnitude > 0.0 &&
         std::isfinite(point.phase_rad) && point.of_magnitude.expanded > 0.0 &&
         point.of_phase.expanded > 0.0;
}

bool is_wanted(const StoredValue& point, const std::string& channel,
               std::optional<double> frequency_hz) {
  constexpr double same_frequency_rel = 1e-6;
  return (channel.empty() || point.channel == channel) &&
         (!frequency_hz ||
          std::abs(point.frequency_hz - *frequency_hz) <= same_frequency_rel * *frequency_hz);
}

bool are_comparable(const HistoryValue& before, const HistoryValue& value,
                    const std::vector<Calibration>& calibrations) {
  const StoredRun& a = calibrations[before.calibration].run;
  const StoredRun& b = calibrations[value.calibration].run;
  const bool same_run = a.bench == b.bench && a.run == b.run && a.began_utc == b.began_utc;
  constexpr double same_level_rel = 0.05;
  const bool same_level = !(std::abs(before.point.level_m_s2 - value.point.level_m_s2) >
                            same_level_rel * std::abs(value.point.level_m_s2));
  return !same_run && same_level && before.point.unit == value.point.unit;
}

void compare(const HistoryLine& line, const std::vector<Calibration>& calibrations,
             HistoryValue& value) {
  const StoredValue& first = line.values.front().point;
  value.deviation_magnitude_rel = value.point.magnitude / first.magnitude - 1.0;
  value.deviation_phase_rad =
      std::remainder(value.point.phase_rad - first.phase_rad, 2.0 * std::numbers::pi);
  const HistoryValue& before = line.values.back();
  if (!are_comparable(before, value, calibrations)) {
    return;
  }
  const auto comparison =
      analysis::compare_transfer(comparable(value.point), comparable(before.point));
  if (comparison) {
    value.en_magnitude = comparison->en_magnitude;
    value.en_phase = comparison->en_phase;
  }
}

} // namespace

bool HistoryValue::agrees() const {
  return std::abs(en_magnitude.value_or(0.0)) <= 1.0 && std::abs(en_phase.value_or(0.0)) <= 1.0;
}

History history_of(std::string sensor, std::vector<Calibration> calibrations,
                   const std::string& channel, std::optional<double> frequency_hz) {
  std::map<std::pair<std::string, double>, HistoryLine> lines;
  for (std::size_t i = 0; i < calibrations.size(); ++i) {
    for (const StoredValue& point : calibrations[i].points) {
      if (!is_usable(point) || !is_wanted(point, channel, frequency_hz)) {
        continue;
      }
      HistoryLine& line = lines[{point.channel, point.frequency_hz}];
      line.channel = point.channel;
      line.frequency_text_hz = point.frequency_text_hz;
      line.frequency_hz = point.frequency_hz;
      HistoryValue value{.calibration = i, .point = point};
      if (!line.values.empty()) {
        compare(line, calibrations, value);
      }
      line.values.push_back(std::move(value));
    }
  }
  History history{std::move(sensor), std::move(calibrations), {}};
  for (auto& [place, line] : lines) {
    history.lines.push_back(std::move(line));
  }
  return history;
}

} // namespace dyncal::inline records
