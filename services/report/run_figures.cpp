#include "services/report/run_figures.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "services/contract/unit.hpp"
#include "services/report/figures/sample_clock.hpp"
#include "services/report/figures/transfer_function.hpp"
#include "services/report/run_report.hpp"

namespace dyncal::services {
namespace {

std::string file_name(const std::string& what, std::string of) {
  std::replace(of.begin(), of.end(), '/', '-');
  return what + "-" + of;
}

std::string run_line(const RunOutcome& outcome) {
  return fmt::format("bench {}, run {}", outcome.measurement.bench().c_str(),
                     outcome.measurement.run().c_str());
}

figures::TransferFunctionData transfer_data(const RunOutcome& outcome,
                                            const wire::TransferFunction& function) {
  figures::TransferFunctionData data;
  data.title = function.channel().to_string();
  data.subtitle = run_line(outcome);
  data.unit = short_form(function.unit());
  for (const wire::CalibrationResult& result : outcome.results) {
    if (result.valid() && result.channel() == function.channel()) {
      data.repetitions.push_back({result.repetition(),
                                  {result.frequency_hz(), result.magnitude(), result.u_magnitude(),
                                   result.phase_rad(), result.u_phase_rad()}});
    }
  }
  for (const wire::TransferPoint& point : function.points()) {
    data.mean.push_back({point.frequency_hz(), point.magnitude(), point.u_magnitude(),
                         point.unwrapped_phase_rad(), point.u_phase_rad()});
  }
  if (function.group_delay_valid()) {
    data.group_delay = figures::GroupDelay{function.group_delay_s(), function.u_group_delay_s(),
                                           function.intercept_rad()};
  }
  return data;
}

figures::IntervalHistogramData histogram_data(const wire::SampleClockReport& report) {
  figures::IntervalHistogramData data;
  data.title = fmt::format("Sample intervals of {}", report.source().c_str());
  data.tick_s = report.tick_s();
  data.mean_interval_s = report.mean_interval_s();
  data.sd_s = report.sd_interval_s();
  data.minimum_s = report.min_interval_s();
  data.maximum_s = report.max_interval_s();
  for (const wire::HistogramBin& bin : report.histogram()) {
    data.counts.push_back({bin.interval_ticks(), bin.interval_ns(), bin.interval_count()});
  }
  return data;
}

figures::IntervalOverTemperatureData temperature_data(const RunOutcome& outcome,
                                                      const wire::SampleClockReport& report) {
  figures::IntervalOverTemperatureData data;
  data.title = fmt::format("Sample interval of {} over its temperature", report.source().c_str());
  data.subtitle = run_line(outcome);
  data.temperature_degc = report.scatter_temperature_degc();
  data.interval_ns = report.scatter_interval_ns();
  for (const wire::TemperatureBin& bin : report.over_temperature()) {
    data.bins.push_back({bin.temperature_degc(), bin.mean_interval_ns(), bin.sd_interval_ns(),
                         bin.interval_count()});
  }
  return data;
}

figures::IntervalOverTimeData time_data(const RunOutcome& outcome,
                                        const wire::SampleClockReport& report) {
  figures::IntervalOverTimeData data;
  data.title = fmt::format("Sample interval of {} over time", report.source().c_str());
  data.subtitle = run_line(outcome);
  for (const wire::IntervalBucket& bucket : report.over_time()) {
    data.overview.push_back({bucket.time_s(), bucket.min_interval_ns(), bucket.max_interval_ns(),
                             bucket.mean_interval_ns()});
  }
  data.close_up_first_time_s = report.close_up_begin_s();
  data.close_up_ns = report.close_up_interval_ns();
  return data;
}

} // namespace

Expected<std::vector<std::filesystem::path>> write_figures(const RunOutcome& outcome,
                                                           const std::filesystem::path& folder) {
  std::vector<figures::Figure> drawn;
  for (const wire::TransferFunction& function : outcome.transfer_functions) {
    if (responds(function)) {
      drawn.push_back(figures::transfer_function_figure(
          transfer_data(outcome, function),
          file_name("transfer-function", function.channel().to_string())));
    }
  }
  for (const wire::SampleClockReport& report : outcome.clock_reports) {
    if (report.interval_count() == 0) {
      continue; // series have no stamps
    }
    const std::string source = report.source().to_string();
    drawn.push_back(figures::interval_histogram_figure(histogram_data(report),
                                                       file_name("interval-histogram", source)));
    drawn.push_back(figures::interval_over_time_figure(time_data(outcome, report),
                                                       file_name("interval-over-time", source)));
    if (!report.scatter_temperature_degc().empty()) {
      drawn.push_back(figures::interval_over_temperature_figure(
          temperature_data(outcome, report), file_name("interval-over-temperature", source)));
    }
  }
  std::vector<std::filesystem::path> paths;
  for (const figures::Figure& figure : drawn) {
    const auto written = figures::write(figure, folder);
    if (!written) {
      return fail(written.error());
    }
    paths.insert(paths.end(), written->begin(), written->end());
  }
  return paths;
}

} // namespace dyncal::services
