// `dyncal intervals DATA.csv`: the sample clock of a recorded series by direct sample interval
// evaluation (paper section 3, analysis/clock/sample_clock.hpp): statistics, histogram, events.
// Belongs to one thread.
#include <cmath>
#include <filesystem>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "analysis/clock/sample_clock.hpp"
#include "services/base/json_text.hpp"
#include "services/base/rounding.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/replay/series_file.hpp"
#include "services/views/report/expanded_uncertainty.hpp"
#include "services/views/report/json_members.hpp"

namespace dyncal::inline programs {
namespace {

struct IntervalsOptions {
  std::filesystem::path file;
  std::string temperature; // column, "" for none
  analysis::SampleClockSettings clock;
  bool json = false;
};

void add_intervals(CLI::App& command, IntervalsOptions& intervals) {
  command.add_option("DATA.csv", intervals.file, "CSV with a header line, or .npy: column t_ns")
      ->required();
  command.add_option("--temperature", intervals.temperature,
                     "column with the sensor's temperature");
  add_checked(command, "--tick", intervals.clock.tick_s,
              "tick of the counter that made the stamps, in seconds", CLI::PositiveNumber);
  add_checked(command, "--nominal-rate", intervals.clock.nominal_rate_hz,
              "nominal sample rate in Hz", CLI::PositiveNumber);
  command.add_flag("--json", intervals.json, "print JSON");
}

using Json = nlohmann::ordered_json;

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

// As in a result file, with all that one has no room for.
void print_json(const analysis::SampleClockStatistics& clock) {
  ClockReport report;
  report.clock = clock;
  Json json = JsonWriter::of(report);
  for (const char* of_a_run : {"source", "flags", "flag_names"}) {
    json.erase(of_a_run);
  }
  json["spread_s"] = clock.maximum_s - clock.minimum_s;
  json["core_mean_s"] = clock.core_mean_s;
  json["core_sd_s"] = clock.core_sd_s;
  json["modes_s"] = clock.modes_s;
  json["left_out_jumps"] = clock.left_out_jumps;
  json["largest_jump_s"] = clock.largest_jump_s;
  json["pair_count"] = clock.pair_count;
  json["pair_regularity"] = clock.pair_regularity;
  for (const analysis::IntervalHistogramBin& bin : clock.histogram) {
    json["histogram"].push_back(
        {{"ticks", bin.ticks}, {"interval_ns", bin.interval_ns}, {"count", bin.count}});
  }
  for (const analysis::AllanPoint& point : clock.allan) {
    json["allan"].push_back({{"tau_s", point.tau_s}, {"deviation", point.deviation}});
  }
  fmt::print("{}\n", json_text(json, 1));
}

std::string u_text(const analysis::CombinedUncertainty& of_interval) {
  return std::isfinite(of_interval.u)
             ? fmt::format("u = {:.2g} us{}", of_interval.u * 1e6, notable_k_text(of_interval.k))
             : "u not known";
}

std::string deviation_text(const analysis::SampleClockStatistics& clock) {
  if (!(clock.nominal_rate_hz > 0.0)) {
    return "";
  }
  const RoundedValue ppm =
      round_by_uncertainty(1e6 * clock.rate_deviation_rel(), 1e6 * clock.of_rate_deviation().u);
  return std::isfinite(clock.u_mean_interval_s)
             ? fmt::format(", {} ppm of nominal, u = {} ppm", ppm.value, ppm.u)
             : fmt::format(", {} ppm of nominal", ppm.value);
}

void print_table(const analysis::SampleClockStatistics& clock) {
  fmt::print("{} intervals, mean {:.6f} us, {}, rate {:.6f} Hz{}\n", clock.intervals,
             clock.mean_interval_s * 1e6, u_text(clock.of_mean_interval()), clock.mean_rate_hz,
             deviation_text(clock));
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

Expected<analysis::SampleClockStatistics> evaluate(const IntervalsOptions& command) {
  const WorkProgress progress("reading");
  DYNCAL_TRY(const auto series, read_series_file(command.file, progress.count()));
  std::span<const double> temperature;
  if (!command.temperature.empty()) {
    DYNCAL_TRY(temperature, series.column(command.temperature));
  }
  progress.count()->begin("evaluating", "", 0);
  analysis::SampleClock clock(command.clock);
  push_series(series, temperature, clock);
  const auto statistics = clock.statistics();
  return statistics
             ? Expected<analysis::SampleClockStatistics>(*statistics)
             : fail(ErrorCode::bad_file,
                    fmt::format("{}: fewer than three samples: too few to evaluate intervals",
                                command.file.string()));
}

Expected<void> run_intervals(const IntervalsOptions& command) {
  DYNCAL_TRY(const auto statistics, evaluate(command));
  command.json ? print_json(statistics) : print_table(statistics);
  return {};
}

const Command intervals_command{250, "intervals",
                                "sample intervals of a recorded series: statistics and events",
                                add_intervals, run_intervals};

} // namespace
} // namespace dyncal::inline programs
