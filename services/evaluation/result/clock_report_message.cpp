#include "services/evaluation/result/clock_report_message.hpp"

#include <cmath>

#include "services/base/version.hpp"

namespace dyncal::inline evaluation {
namespace {

void write_numbers(const analysis::SampleClockStatistics& clock, wire::SampleClockReport& report) {
  report.interval_count(clock.intervals);
  report.mean_interval_s(clock.mean_interval_s);
  report.u_mean_interval_s(clock.u_mean_interval_s);
  report.sd_interval_s(clock.sd_s);
  report.min_interval_s(clock.minimum_s);
  report.max_interval_s(clock.maximum_s);
  report.median_interval_s(clock.median_s);
  report.mad_sd_interval_s(clock.mad_sd_s);
  report.p0_1_interval_s(clock.quantile_001_s);
  report.p1_interval_s(clock.quantile_01_s);
  report.p99_interval_s(clock.quantile_99_s);
  report.p99_9_interval_s(clock.quantile_999_s);
  report.nominal_rate_hz(clock.nominal_rate_hz);
  report.mean_rate_hz(clock.mean_rate_hz);
  report.tick_s(clock.tick_s);
  report.lattice_statistic(clock.lattice_statistic);
  report.event_count(clock.event_count);
  report.pair_period_samples(clock.pair_period_samples);
  report.pair_period_s(clock.pair_period_s);
  report.temperature_correlation(clock.temperature_correlation);
  report.temperature_slope_s_per_degc(clock.temperature_slope_s_per_degc);
  report.close_up_begin_s(clock.close_up_first_time_s);
  report.lost(clock.lost);
}

void write_lists(const analysis::SampleClockStatistics& clock, wire::SampleClockReport& report) {
  report.mode_intervals_s() = clock.modes_s;
  report.close_up_interval_ns() = clock.close_up_ns;
  report.scatter_temperature_degc() = clock.scatter_temperature_degc;
  report.scatter_interval_ns() = clock.scatter_interval_ns;
  for (const analysis::IntervalHistogramBin& bin : clock.histogram) {
    wire::HistogramBin message;
    message.interval_ticks(bin.ticks);
    message.interval_ns(bin.interval_ns);
    message.interval_count(bin.count);
    report.histogram().push_back(message);
  }
  for (const analysis::IntervalBucket& bucket : clock.over_time) {
    wire::IntervalBucket message;
    message.time_s(bucket.time_s);
    message.min_interval_ns(bucket.minimum_ns);
    message.max_interval_ns(bucket.maximum_ns);
    message.mean_interval_ns(bucket.mean_ns);
    report.over_time().push_back(message);
  }
  for (const analysis::IntervalEvent& event : clock.events) {
    wire::IntervalEvent message;
    message.kind(event.kind);
    message.sample(event.sample);
    message.time_s(event.time_s);
    message.size_ns(event.size_ns);
    message.missing_samples(event.missing);
    report.events().push_back(message);
  }
  for (const analysis::TemperatureBin& bin : clock.over_temperature) {
    wire::TemperatureBin message;
    message.temperature_degc(bin.temperature_degc);
    message.mean_interval_ns(bin.mean_interval_ns);
    message.sd_interval_ns(bin.sd_interval_ns);
    message.interval_count(bin.count);
    report.over_temperature().push_back(message);
  }
  for (const analysis::AllanPoint& point : clock.allan) {
    wire::AllanPoint message;
    message.tau_s(point.tau_s);
    message.deviation_rel(point.deviation);
    report.allan().push_back(message);
  }
}

void read_numbers(const wire::SampleClockReport& report, analysis::SampleClockStatistics& clock) {
  clock.intervals = report.interval_count();
  clock.mean_interval_s = report.mean_interval_s();
  clock.u_mean_interval_s = report.u_mean_interval_s();
  clock.sd_s = report.sd_interval_s();
  clock.minimum_s = report.min_interval_s();
  clock.maximum_s = report.max_interval_s();
  clock.median_s = report.median_interval_s();
  clock.mad_sd_s = report.mad_sd_interval_s();
  clock.quantile_001_s = report.p0_1_interval_s();
  clock.quantile_01_s = report.p1_interval_s();
  clock.quantile_50_s = report.median_interval_s();
  clock.quantile_99_s = report.p99_interval_s();
  clock.quantile_999_s = report.p99_9_interval_s();
  clock.nominal_rate_hz = report.nominal_rate_hz();
  clock.mean_rate_hz = report.mean_rate_hz();
  clock.tick_s = report.tick_s();
  clock.lattice_statistic = report.lattice_statistic();
  clock.event_count = report.event_count();
  clock.pair_period_samples = report.pair_period_samples();
  clock.pair_period_s = report.pair_period_s();
  clock.temperature_correlation = report.temperature_correlation();
  clock.temperature_slope_s_per_degc = report.temperature_slope_s_per_degc();
  clock.close_up_first_time_s = report.close_up_begin_s();
  clock.lost = report.lost();
}

void read_lists(const wire::SampleClockReport& report, analysis::SampleClockStatistics& clock) {
  clock.modes_s = report.mode_intervals_s();
  clock.close_up_ns = report.close_up_interval_ns();
  clock.scatter_temperature_degc = report.scatter_temperature_degc();
  clock.scatter_interval_ns = report.scatter_interval_ns();
  for (const wire::HistogramBin& bin : report.histogram()) {
    clock.histogram.push_back({bin.interval_ticks(), bin.interval_ns(), bin.interval_count()});
  }
  for (const wire::IntervalBucket& bucket : report.over_time()) {
    clock.over_time.push_back({bucket.time_s(), bucket.min_interval_ns(), bucket.max_interval_ns(),
                               bucket.mean_interval_ns()});
  }
  for (const wire::IntervalEvent& event : report.events()) {
    clock.events.push_back(
        {event.kind(), event.sample(), event.time_s(), event.size_ns(), event.missing_samples()});
  }
  for (const wire::TemperatureBin& bin : report.over_temperature()) {
    clock.over_temperature.push_back({bin.temperature_degc(), bin.mean_interval_ns(),
                                      bin.sd_interval_ns(), bin.interval_count()});
  }
  for (const wire::AllanPoint& point : report.allan()) {
    clock.allan.push_back({point.tau_s(), point.deviation_rel()});
  }
}

} // namespace

wire::SampleClockReport to_message(const Recipe& recipe, const ClockReport& report) {
  wire::SampleClockReport message;
  message.bench(recipe.bench);
  message.run(recipe.run);
  message.source(report.source);
  message.software(software_version());
  write_numbers(report.clock, message);
  write_lists(report.clock, message);
  message.flags() = sentences_of(report.flags);
  message.flag_names() = names_of(report.flags);
  if (report.last_block) {
    message.last_session(report.last_block->session);
    message.last_block(report.last_block->number);
  }
  return message;
}

ClockReport from_message(const wire::SampleClockReport& message) {
  ClockReport report;
  report.source = message.source().to_string();
  read_numbers(message, report.clock);
  read_lists(message, report.clock);
  report.flags = flags_from_message(message.flags(), message.flag_names());
  if (message.last_session() != 0) {
    report.last_block = BlockPosition{message.last_session(), message.last_block()};
  }
  if (report.flags.empty() && std::isnan(report.clock.u_mean_interval_s)) { // of an older writer
    report.flags.push_back(make_flag(ResultFlag::clock_uncertainty_unknown));
  }
  return report;
}

} // namespace dyncal::inline evaluation
