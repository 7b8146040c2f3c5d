#include "services/programs/command/intervals_command.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "analysis/clock/sample_clock.hpp"
#include "services/base/json_text.hpp"
#include "services/daemon/program/program.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/replay/series_file.hpp"

namespace dyncal::inline programs {
namespace {

using Json = nlohmann::ordered_json;

Json events_json(const analysis::SampleClockStatistics& clock) {
  Json events = Json::array();
  for (const analysis::IntervalEvent& event : clock.events) {
    events.push_back({{"kind", event.kind},
                      {"sample", event.sample},
                      {"time_s", event.time_s},
                      {"size_ns", event.size_ns},
                      {"missing", event.missing}});
  }
  return events;
}

Json histogram_json(const analysis::SampleClockStatistics& clock) {
  Json bins = Json::array();
  for (const analysis::IntervalHistogramBin& bin : clock.histogram) {
    bins.push_back({{"ticks", bin.ticks}, {"interval_ns", bin.interval_ns}, {"count", bin.count}});
  }
  return bins;
}

Json allan_json(const analysis::SampleClockStatistics& clock) {
  Json points = Json::array();
  for (const analysis::AllanPoint& point : clock.allan) {
    points.push_back({{"tau_s", point.tau_s}, {"deviation", point.deviation}});
  }
  return points;
}

// The numbering of the file shows what is missing; stamps that are not in order are events.
void push_series(const SeriesFile& series, std::span<const double> temperature,
                 analysis::SampleClock& clock) {
  const std::span<const std::int64_t> stamps(series.stamps_ns);
  const std::vector<std::uint64_t>& numbers = series.sample_numbers;
  for (std::size_t begin = 0; begin < stamps.size();) {
    std::size_t end = begin + 1;
    while (end < stamps.size() && numbers[end] == numbers[end - 1] + 1) {
      ++end;
    }
    clock.push(numbers[begin], stamps.subspan(begin, end - begin), {},
               temperature.empty() ? temperature : temperature.subspan(begin, end - begin));
    begin = end;
  }
}

// JSON has no NaN: null says that nothing is known.
Json known(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

void print_json(const analysis::SampleClockStatistics& clock) {
  const Json json{{"count", clock.intervals},
                  {"mean_interval_s", clock.mean_interval_s},
                  {"u_mean_interval_s", known(clock.u_mean_interval_s)},
                  {"sd_s", clock.sd_s},
                  {"min_s", clock.minimum_s},
                  {"max_s", clock.maximum_s},
                  {"spread_s", clock.maximum_s - clock.minimum_s},
                  {"median_s", clock.median_s},
                  {"mad_sd_s", clock.mad_sd_s},
                  {"quantiles_s",
                   {{"0.001", clock.quantile_001_s},
                    {"0.01", clock.quantile_01_s},
                    {"0.5", clock.quantile_50_s},
                    {"0.99", clock.quantile_99_s},
                    {"0.999", clock.quantile_999_s}}},
                  {"core_mean_s", clock.core_mean_s},
                  {"core_sd_s", clock.core_sd_s},
                  {"mean_rate_hz", clock.mean_rate_hz},
                  {"tick_s", clock.tick_s},
                  {"lattice_statistic", clock.lattice_statistic},
                  {"modes_s", clock.modes_s},
                  {"lost", clock.lost},
                  {"left_out_jumps", clock.left_out_jumps},
                  {"largest_jump_s", clock.largest_jump_s},
                  {"event_count", clock.event_count},
                  {"pair_count", clock.pair_count},
                  {"pair_period_samples", clock.pair_period_samples},
                  {"pair_period_s", clock.pair_period_s},
                  {"pair_regularity", clock.pair_regularity},
                  {"temperature_correlation", clock.temperature_correlation},
                  {"temperature_slope_s_per_degc", clock.temperature_slope_s_per_degc},
                  {"events", events_json(clock)},
                  {"histogram", histogram_json(clock)},
                  {"allan", allan_json(clock)}};
  fmt::print("{}\n", json_text(json, 1));
}

std::string u_text(double u_mean_interval_s) {
  return std::isfinite(u_mean_interval_s) ? fmt::format("u = {:.2g} us", u_mean_interval_s * 1e6)
                                          : "u not known";
}

void print_table(const analysis::SampleClockStatistics& clock) {
  fmt::print("{} intervals, mean {:.6f} us, {}, rate {:.6f} Hz\n", clock.intervals,
             clock.mean_interval_s * 1e6, u_text(clock.u_mean_interval_s), clock.mean_rate_hz);
  fmt::print("sd {:.2f} ns, robust sd {:.2f} ns, smallest {:.3f} us, median {:.3f} us, largest "
             "{:.3f} us, spread {:.0f} ns\n",
             clock.sd_s * 1e9, clock.mad_sd_s * 1e9, clock.minimum_s * 1e6, clock.median_s * 1e6,
             clock.maximum_s * 1e6, (clock.maximum_s - clock.minimum_s) * 1e9);
  if (clock.pair_period_samples > 0.0) {
    fmt::print("{} late/early pairs, one every {:.0f} samples ({:.4f} s)\n", clock.pair_count,
               clock.pair_period_samples, clock.pair_period_s);
  }
  fmt::print("{} events, {} samples lost\n", clock.event_count, clock.lost);
  if (clock.left_out_jumps > 0) {
    fmt::print(
        "the mean leaves out {} jump{} of the clock, or pauses too long to count; the largest "
        "is {:+.6f} s\n",
        clock.left_out_jumps, clock.left_out_jumps == 1 ? "" : "s", clock.largest_jump_s);
  }
  for (const analysis::IntervalEvent& event : clock.events) {
    fmt::print("  {:>9} at sample {:>10}, {:>12.6f} s, {:+.0f} ns{}\n", event.kind, event.sample,
               event.time_s, event.size_ns,
               event.missing > 0 ? fmt::format(", {} missing", event.missing) : "");
  }
}

} // namespace

int run_intervals(const IntervalsCommand& command) {
  const auto series = [&] {
    const WorkProgress progress("reading");
    return read_series_file(command.file, progress.count());
  }();
  if (!series) {
    return report_error(series.error());
  }
  std::span<const double> temperature;
  if (!command.temperature.empty()) {
    const auto column = series->column(command.temperature);
    if (!column) {
      return report_error(
          {ErrorCode::bad_argument,
           fmt::format("{}: there is no column '{}'; the columns are: {}", command.file.string(),
                       command.temperature, fmt::join(series->names, ", "))});
    }
    temperature = series->columns[*column];
  }
  analysis::SampleClockSettings settings;
  settings.tick_s = command.tick_s;
  settings.nominal_rate_hz = command.nominal_rate_hz;
  analysis::SampleClock clock(settings);
  const auto statistics = [&] {
    const WorkProgress progress("evaluating");
    push_series(*series, temperature, clock);
    return clock.statistics();
  }();
  if (!statistics) {
    return report_error({ErrorCode::bad_file,
                         fmt::format("{}: fewer than three samples: too few to evaluate intervals",
                                     command.file.string())});
  }
  command.json ? print_json(*statistics) : print_table(*statistics);
  return 0;
}

} // namespace dyncal::inline programs
