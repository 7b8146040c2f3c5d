#include "services/report/run_figures.hpp"

#include <algorithm>
#include <limits>

#include <fmt/core.h>

#include "services/contract/unit.hpp"
#include "services/report/expanded_uncertainty.hpp"
#include "services/report/figures/deviation.hpp"
#include "services/report/figures/sample_clock.hpp"
#include "services/report/flag_legend.hpp"
#include "services/report/result_table.hpp"

namespace dyncal::services {
namespace {

std::string file_name(const std::string& what, std::string of) {
  std::replace(of.begin(), of.end(), '/', '-');
  return what + "-" + of;
}

std::string run_line(const RunOutcome& outcome) {
  return fmt::format("bench {}, run {}", outcome.bench, outcome.run);
}

double fit_residual(const StepResult& result) {
  const auto own =
      std::find_if(result.signals.begin(), result.signals.end(),
                   [&](const ChannelSignal& signal) { return signal.channel == result.channel; });
  return own == result.signals.end() ? std::numeric_limits<double>::quiet_NaN() : own->residual;
}

figures::TransferFunctionData transfer_data(const RunOutcome& outcome,
                                            const TransferFunction& function) {
  figures::TransferFunctionData data;
  data.title = function.channel;
  data.subtitle = run_line(outcome);
  data.unit = short_form(function.unit);
  for (const StepResult& result : outcome.results) {
    if (result.valid && result.channel == function.channel) {
      data.repetitions.push_back(
          {result.repetition,
           {result.frequency_hz,
            result.level_m_s2,
            {result.magnitude, result.u_magnitude, result.phase_rad, result.u_phase_rad},
            flag_names(result.flags)},
           fit_residual(result)});
    }
  }
  for (const FrequencyPoint& point : function.points) {
    const ExpandedUncertainty magnitude = magnitude_uncertainty(point.mean);
    const ExpandedUncertainty phase = phase_uncertainty(point.mean);
    data.mean.push_back({point.frequency_hz,
                         point.level_m_s2,
                         {point.mean.magnitude, magnitude.u, point.unwrapped_phase_rad, phase.u},
                         flag_names(flags_of(outcome, function.channel, point)),
                         magnitude.expanded,
                         phase.expanded});
  }
  for (const FlagMeaning& meaning : flag_legend(flags_of(outcome, function))) {
    data.legend.push_back(legend_line(meaning));
  }
  data.group_delay = function.group_delay;
  return data;
}

std::vector<figures::Figure> clock_figures(const RunOutcome& outcome, const ClockReport& report) {
  if (report.clock.intervals == 0) {
    return {}; // series have no stamps
  }
  const std::string& source = report.source;
  const std::string subtitle = run_line(outcome);
  std::vector<figures::Figure> drawn{
      figures::interval_histogram_figure({fmt::format("Sample intervals of {}", source)},
                                         report.clock, file_name("interval-histogram", source)),
      figures::interval_over_time_figure(
          {fmt::format("Sample interval of {} over time", source), subtitle}, report.clock,
          file_name("interval-over-time", source))};
  if (!report.clock.scatter_temperature_degc.empty()) {
    drawn.push_back(figures::interval_over_temperature_figure(
        {fmt::format("Sample interval of {} over its temperature", source), subtitle}, report.clock,
        file_name("interval-over-temperature", source)));
  }
  return drawn;
}

} // namespace

std::vector<figures::Figure> run_figures(const RunOutcome& outcome, figures::ErrorBars error_bars) {
  std::vector<figures::Figure> drawn;
  for (const TransferFunction& function : outcome.transfer_functions) {
    if (responds(function)) {
      figures::TransferFunctionData data = transfer_data(outcome, function);
      data.error_bars = error_bars;
      drawn.push_back(figures::transfer_function_figure(
          data, file_name("transfer-function", function.channel)));
      drawn.push_back(figures::deviation_figure(data, file_name("deviation", function.channel)));
    }
  }
  for (const ClockReport& report : outcome.clock_reports) {
    for (figures::Figure& figure : clock_figures(outcome, report)) {
      drawn.push_back(std::move(figure));
    }
  }
  return drawn;
}

Expected<std::vector<std::filesystem::path>> write_figures(const RunOutcome& outcome,
                                                           const std::filesystem::path& folder,
                                                           figures::ErrorBars error_bars) {
  std::vector<std::filesystem::path> paths;
  for (const figures::Figure& figure : run_figures(outcome, error_bars)) {
    const auto written = figures::write(figure, folder);
    if (!written) {
      return fail(written.error());
    }
    paths.insert(paths.end(), written->begin(), written->end());
  }
  return paths;
}

} // namespace dyncal::services
