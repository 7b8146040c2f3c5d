#include "services/evaluation/result/result_messages.hpp"

#include <cmath>

#include "services/base/version.hpp"
#include "services/contract/message_members.hpp"
#include "services/evaluation/result/flag_message.hpp"

namespace dyncal::inline evaluation {

void message_members(auto& visit, Either<analysis::IntervalHistogramBin> auto& bin, auto& message) {
  visit(bin.ticks, message.interval_ticks());
  visit(bin.interval_ns, message.interval_ns());
  visit(bin.count, message.interval_count());
}

void message_members(auto& visit, Either<analysis::IntervalBucket> auto& bucket, auto& message) {
  visit(bucket.time_s, message.time_s());
  visit(bucket.minimum_ns, message.min_interval_ns());
  visit(bucket.maximum_ns, message.max_interval_ns());
  visit(bucket.mean_ns, message.mean_interval_ns());
}

void message_members(auto& visit, Either<analysis::IntervalEvent> auto& event, auto& message) {
  visit(event.kind, message.kind());
  visit(event.sample, message.sample());
  visit(event.time_s, message.time_s());
  visit(event.size_ns, message.size_ns());
  visit(event.missing, message.missing_samples());
}

void message_members(auto& visit, Either<analysis::TemperatureBin> auto& bin, auto& message) {
  visit(bin.temperature_degc, message.temperature_degc());
  visit(bin.mean_interval_ns, message.mean_interval_ns());
  visit(bin.sd_interval_ns, message.sd_interval_ns());
  visit(bin.count, message.interval_count());
}

void message_members(auto& visit, Either<analysis::AllanPoint> auto& point, auto& message) {
  visit(point.tau_s, message.tau_s());
  visit(point.deviation, message.deviation_rel());
}

void message_members(auto& visit, Either<analysis::SampleClockStatistics> auto& clock,
                     auto& report) {
  visit(clock.intervals, report.interval_count());
  visit(clock.mean_interval_s, report.mean_interval_s());
  visit(clock.u_mean_interval_s, report.u_mean_interval_s());
  visit(clock.sd_s, report.sd_interval_s());
  visit(clock.minimum_s, report.min_interval_s());
  visit(clock.maximum_s, report.max_interval_s());
  visit(clock.median_s, report.median_interval_s());
  visit(clock.mad_sd_s, report.mad_sd_interval_s());
  visit(clock.quantile_001_s, report.p0_1_interval_s());
  visit(clock.quantile_01_s, report.p1_interval_s());
  visit(clock.quantile_99_s, report.p99_interval_s());
  visit(clock.quantile_999_s, report.p99_9_interval_s());
  visit(clock.nominal_rate_hz, report.nominal_rate_hz());
  visit(clock.mean_rate_hz, report.mean_rate_hz());
  visit(clock.tick_s, report.tick_s());
  visit(clock.lattice_statistic, report.lattice_statistic());
  visit(clock.modes_s, report.mode_intervals_s());
  visit(clock.histogram, report.histogram());
  visit(clock.over_time, report.over_time());
  visit(clock.close_up_first_time_s, report.close_up_begin_s());
  visit(clock.close_up_ns, report.close_up_interval_ns());
  visit(clock.events, report.events());
  visit(clock.event_count, report.event_count());
  visit(clock.pair_period_samples, report.pair_period_samples());
  visit(clock.pair_period_s, report.pair_period_s());
  visit(clock.over_temperature, report.over_temperature());
  visit(clock.scatter_temperature_degc, report.scatter_temperature_degc());
  visit(clock.scatter_interval_ns, report.scatter_interval_ns());
  visit(clock.temperature_correlation, report.temperature_correlation());
  visit(clock.temperature_slope_s_per_degc, report.temperature_slope_s_per_degc());
  visit(clock.allan, report.allan());
  visit(clock.lost, report.lost());
  visit(clock.degrees_of_freedom_mean_interval, report.nu_eff_mean_interval());
  visit(clock.k_mean_interval, report.k_mean_interval());
}

wire::SampleClockReport to_message(const Recipe& recipe, const ClockReport& report) {
  wire::SampleClockReport message;
  message.bench(recipe.bench);
  message.run(recipe.run);
  message.source(report.source);
  message.software(software_version());
  MessageWriter writer;
  message_members(writer, report.clock, message);
  message_flags(writer, report.flags, message);
  if (report.last_block) {
    message.last_session(report.last_block->session);
    message.last_block(report.last_block->number);
  }
  return message;
}

ClockReport from_message(const wire::SampleClockReport& message) {
  ClockReport report;
  report.source = message.source().to_string();
  MessageReader reader;
  message_members(reader, report.clock, message);
  report.clock.quantile_50_s = report.clock.median_s;
  if (report.clock.k_mean_interval == 0.0) { // of an older writer
    report.clock.k_mean_interval = 2.0;
    report.clock.degrees_of_freedom_mean_interval = analysis::infinite_degrees_of_freedom;
  }
  message_flags(reader, report.flags, message);
  if (message.last_session() != 0) {
    report.last_block = BlockPosition{message.last_session(), message.last_block()};
  }
  if (report.flags.empty() && std::isnan(report.clock.u_mean_interval_s)) { // of an older writer
    report.flags.push_back(make_flag(ResultFlag::clock_uncertainty_unknown));
  }
  return report;
}

} // namespace dyncal::inline evaluation
