#include "services/views/report/clock_json.hpp"

#include "services/views/report/json_number.hpp"

namespace dyncal::services {
namespace {

using Json = nlohmann::ordered_json;

Json events_json(const analysis::SampleClockStatistics& clock) {
  Json events = Json::array();
  for (const analysis::IntervalEvent& event : clock.events) {
    events.push_back({{"kind", event.kind},
                      {"sample", event.sample},
                      {"time_s", json_number(event.time_s)},
                      {"size_ns", json_number(event.size_ns)},
                      {"missing", event.missing}});
  }
  return events;
}

// Range and mean of the sensor's temperature over the run.
Json temperature_json(const analysis::SampleClockStatistics& clock) {
  double sum = 0.0;
  double count = 0.0;
  for (const analysis::TemperatureBin& bin : clock.over_temperature) {
    sum += bin.temperature_degc * static_cast<double>(bin.count);
    count += static_cast<double>(bin.count);
  }
  if (count == 0.0) {
    return nullptr;
  }
  return {{"minimum", json_number(clock.over_temperature.front().temperature_degc)},
          {"mean", json_number(sum / count)},
          {"maximum", json_number(clock.over_temperature.back().temperature_degc)}};
}

} // namespace

nlohmann::ordered_json clock_json(const ClockReport& report) {
  const analysis::SampleClockStatistics& clock = report.clock;
  return {{"source", report.source},
          {"mean_interval_s", json_number(clock.mean_interval_s)},
          {"u_mean_interval_s", json_number(clock.u_mean_interval_s)},
          {"sd_s", json_number(clock.sd_s)},
          {"min_s", json_number(clock.minimum_s)},
          {"max_s", json_number(clock.maximum_s)},
          {"median_s", json_number(clock.median_s)},
          {"mad_sd_s", json_number(clock.mad_sd_s)},
          {"quantiles_s",
           {{"0.001", json_number(clock.quantile_001_s)},
            {"0.01", json_number(clock.quantile_01_s)},
            {"0.5", json_number(clock.quantile_50_s)},
            {"0.99", json_number(clock.quantile_99_s)},
            {"0.999", json_number(clock.quantile_999_s)}}},
          {"count", clock.intervals},
          {"nominal_rate_hz", json_number(clock.nominal_rate_hz)},
          {"mean_rate_hz", json_number(clock.mean_rate_hz)},
          {"tick_s", json_number(clock.tick_s)},
          {"lattice_statistic", json_number(clock.lattice_statistic)},
          {"events", clock.event_count},
          {"event_list", events_json(clock)}, // the first of them
          {"pair_period_samples", json_number(clock.pair_period_samples)},
          {"pair_period_s", json_number(clock.pair_period_s)},
          {"temperature_degc", temperature_json(clock)},
          {"temperature_correlation", json_number(clock.temperature_correlation)},
          {"temperature_slope_s_per_degc", json_number(clock.temperature_slope_s_per_degc)},
          {"lost", clock.lost},
          {"flags", sentences_of(report.flags)},
          {"flag_names", names_of(report.flags)}};
}

} // namespace dyncal::services
