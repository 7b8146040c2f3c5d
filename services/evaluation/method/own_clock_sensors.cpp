#include "services/evaluation/method/own_clock_sensors.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace dyncal::inline evaluation {

bool sensors_have_sent(const Recipe& recipe, const RunRecords& records, std::size_t search,
                       std::size_t step) {
  const auto interval = records.interval(search, step);
  const std::vector<std::string> sources = recipe.dut_sources();
  return !interval || std::all_of(sources.begin(), sources.end(), [&](const std::string& name) {
    const SourceRecord& sensor = records.of(name);
    const auto stamps = sensor.stamps_ns();
    return (!stamps.empty() && stamps.back() >= interval->end_ns) || records.is_over_in(name, step);
  });
}

std::vector<SourceInterval> sensor_intervals(const Recipe& recipe, const RunRecords& records,
                                             const TimeInterval& interval) {
  std::vector<SourceInterval> intervals;
  for (const std::string& source : recipe.dut_sources()) {
    intervals.push_back(records.samples(source, interval));
  }
  return intervals;
}

std::vector<ChannelName> dut_of(const Recipe& recipe, const std::string& source) {
  std::vector<ChannelName> names;
  std::copy_if(recipe.dut().begin(), recipe.dut().end(), std::back_inserter(names),
               [&](const ChannelName& name) { return name.source == source; });
  return names;
}

SelectedChannels select_dut(const Recipe& recipe, const SourceInterval& sensor) {
  return {sensor, dut_of(recipe, sensor.record->source()), recipe.mains_hz};
}

double u_clock_offset_s(const SelectedChannels& a, const SelectedChannels& b) {
  return std::hypot(a.record().stamp_uncertainty_s(a.interval()),
                    b.record().stamp_uncertainty_s(b.interval()));
}

std::optional<double> u_utc_s(const SelectedChannels& acs, const SelectedChannels& dau) {
  const auto has_utc = [](const SelectedChannels& channels) {
    return channels.record().description().time_base == drivers::TimeBase::utc &&
           channels.record().stamp_uncertainty_s(channels.interval()) > 0.0;
  };
  return has_utc(acs) && has_utc(dau) ? std::optional(u_clock_offset_s(acs, dau)) : std::nullopt;
}

void flag_unknown_clock(const SelectedChannels& channels, std::vector<Flag>& flags) {
  if (channels.record().stamp_uncertainty_s(channels.interval()) <= 0.0) {
    flags.push_back(
        flag_of_source(ResultFlag::clock_uncertainty_unknown, channels.record().source()));
  }
}

analysis::Expected<void> require_samples(const SelectedChannels& sensor) {
  if (sensor.stamps_ns().empty()) {
    return fail(analysis::ErrorCode::too_few_samples,
                sensor.record().source() + ": no sample with a trusted stamp lies in the step");
  }
  return {};
}

Expected<void> check_one_time_scale(const Recipe& recipe, const RunRecords& records,
                                    const std::string& link) {
  const SourceRecord& linking = records.of(link);
  for (const std::string& name : recipe.dut_sources()) {
    const SourceRecord& sensor = records.of(name);
    if (sensor.described() && linking.described() &&
        sensor.description().time_base != linking.description().time_base) {
      return fail(ErrorCode::no_source,
                  fmt::format("sources '{}' and '{}' must be stamped on one time scale, but one is "
                              "in UTC and the other has a clock of its own",
                              name, link));
    }
  }
  return {};
}

} // namespace dyncal::inline evaluation
