#include "services/records/store/history.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "services/views/report/result_file.hpp"

namespace dyncal::inline records {
namespace {

bool is_usable(const StoredValue& point) {
  return std::isfinite(point.magnitude) && point.magnitude > 0.0 &&
         std::isfinite(point.phase_rad) && point.of_magnitude.expanded > 0.0 &&
         point.of_phase.expanded > 0.0;
}

bool is_wanted(const StoredValue& point, const HistoryFilter& filter) {
  constexpr double same_rel = 1e-6;
  const auto is_same = [](double value, std::optional<double> wanted) {
    return !wanted || std::abs(value - *wanted) <= same_rel * std::abs(*wanted);
  };
  return (filter.channel.empty() || point.channel == filter.channel) &&
         is_same(point.frequency_hz, filter.frequency_hz) &&
         is_same(point.level_m_s2, filter.level_m_s2);
}

bool are_comparable(const HistoryValue& before, const HistoryValue& value,
                    const std::vector<Calibration>& calibrations) {
  const StoredRun& a = calibrations[before.calibration].run;
  const StoredRun& b = calibrations[value.calibration].run;
  const bool same_run = a.bench == b.bench && a.run == b.run && a.began_utc == b.began_utc;
  return !same_run && before.point.unit == value.point.unit;
}

// At most what leaves the smaller U something of its own: budgets of single results and U of means
// do not agree to the last digit.
analysis::SharedUncertainty shared_of(const HistoryLine& line, const HistoryValue& before,
                                      const HistoryValue& value,
                                      const std::vector<Calibration>& calibrations) {
  constexpr double most = 0.99;
  const CommonParts& a = calibrations[before.calibration].common;
  const CommonParts& b = calibrations[value.calibration].common;
  const auto of_a = a.find(line.point);
  const auto of_b = b.find(line.point);
  if (of_a == a.end() || of_b == b.end()) {
    return {};
  }
  analysis::SharedUncertainty shared = shared_by(of_a->second, of_b->second);
  for (const StoredValue* point : {&before.point, &value.point}) {
    shared.magnitude_rel =
        std::min(shared.magnitude_rel, most * point->of_magnitude.u / point->magnitude);
    shared.phase_rad = std::min(shared.phase_rad, most * point->of_phase.u);
  }
  return shared;
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
      analysis::compare_transfer(comparable(value.point), comparable(before.point),
                                 shared_of(line, before, value, calibrations));
  if (comparison) {
    value.en_magnitude = comparison->magnitude.normalised_error();
    value.en_phase = comparison->phase.normalised_error();
  }
}

} // namespace

bool HistoryValue::agrees() const {
  return std::abs(en_magnitude.value_or(0.0)) <= 1.0 && std::abs(en_phase.value_or(0.0)) <= 1.0;
}

PointDifferences History::differences() const {
  std::vector<PointIdentity> points;
  for (const HistoryLine& line : lines) {
    points.push_back(line.point);
  }
  return differences_of(points);
}

void keep_wanted(Calibration& calibration, const HistoryFilter& filter) {
  std::erase_if(calibration.points,
                [&](const StoredValue& point) { return !is_wanted(point, filter); });
}

History history_of(std::string sensor, std::vector<Calibration> calibrations) {
  std::map<PointIdentity, HistoryLine> lines;
  for (std::size_t i = 0; i < calibrations.size(); ++i) {
    for (const StoredValue& point : calibrations[i].points) {
      if (!is_usable(point)) {
        continue;
      }
      HistoryLine& line = lines[identity_of(point)];
      line.point = identity_of(point);
      line.frequency_text_hz = point.frequency_text_hz;
      HistoryValue value{.calibration = i, .point = point};
      if (!line.values.empty()) {
        compare(line, calibrations, value);
      }
      line.values.push_back(std::move(value));
    }
  }
  std::set<std::string> channels;
  for (const auto& [point, line] : lines) {
    channels.insert(point.channel);
  }
  for (Calibration& calibration : calibrations) {
    std::erase_if(calibration.open_closures,
                  [&](const OpenClosure& one) { return !channels.contains(one.channel); });
  }
  History history{std::move(sensor), std::move(calibrations), {}};
  for (auto& [point, line] : lines) {
    history.lines.push_back(std::move(line));
  }
  return history;
}

} // namespace dyncal::inline records
