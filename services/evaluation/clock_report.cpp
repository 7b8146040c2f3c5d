#include "services/evaluation/clock_report.hpp"

#include <algorithm>

#include "services/version.hpp"

namespace dyncal::services {
namespace {

void fill_numbers(const analysis::SampleClockStatistics& clock, wire::SampleClockReport& report) {
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

void fill_lists(const analysis::SampleClockStatistics& clock, wire::SampleClockReport& report) {
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

} // namespace

ClockReportBuilder::ClockReportBuilder(const Recipe& recipe)
    : bench_(recipe.bench), run_(recipe.run), source_(recipe.sensor_source()) {
  if (recipe.temperature && recipe.temperature->source == source_) {
    temperature_channel_ = recipe.temperature->channel;
  }
}

void ClockReportBuilder::describe(const wire::SourceDescription& description) {
  if (description.source().to_string() != source_ || clock_) {
    return;
  }
  const auto& channels = description.channels();
  const auto found =
      std::find_if(channels.begin(), channels.end(), [&](const wire::ChannelDescription& channel) {
        return temperature_channel_ && channel.name() == *temperature_channel_;
      });
  if (found != channels.end()) {
    temperature_column_ = static_cast<std::size_t>(found - channels.begin());
  }
  analysis::SampleClockSettings settings;
  settings.nominal_rate_hz = description.nominal_rate_hz();
  settings.tick_s = description.tick_s();
  settings.stamp_uncertainty_s = description.stamp_uncertainty_s();
  clock_.emplace(settings);
}

void ClockReportBuilder::add(const wire::SampleBlock& block) {
  if (!clock_ || block.source().to_string() != source_ || block.stamps_ns().empty() ||
      continuity_.add(block).duplicate) {
    return;
  }
  std::span<const double> temperature;
  if (temperature_column_) {
    temperature = std::span(block.values())
                      .subspan(*temperature_column_ * block.sample_count(), block.sample_count());
  }
  clock_->push(block.first_sample(), block.stamps_ns(), block.stamp_flags(), temperature);
}

std::vector<wire::SampleClockReport> ClockReportBuilder::reports() const {
  const auto statistics = clock_ ? clock_->statistics() : std::nullopt;
  if (!statistics) {
    return {};
  }
  wire::SampleClockReport report;
  report.bench(bench_);
  report.run(run_);
  report.source(source_);
  report.software(software_version());
  fill_numbers(*statistics, report);
  fill_lists(*statistics, report);
  return {report};
}

} // namespace dyncal::services
