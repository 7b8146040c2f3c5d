#include "services/views/report/run_figures.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "services/base/output_file.hpp"
#include "services/contract/run_identity.hpp"
#include "services/views/figures/deviation.hpp"
#include "services/views/figures/quadrature_ellipse.hpp"
#include "services/views/figures/sample_clock.hpp"
#include "services/views/report/closures_csv.hpp"
#include "services/views/report/result_table.hpp"
#include "services/views/report/transfer_data.hpp"

namespace dyncal::inline views {
namespace {

std::string file_name(const std::string& what, std::string of) {
  std::replace(of.begin(), of.end(), '/', '-');
  return what + "-" + of;
}

std::string run_line(const RunOutcome& outcome) {
  return fmt::format("bench {}, run {}", outcome.bench, RunIdentity::parse(outcome.run).name);
}

} // namespace

std::vector<figures::Figure> channel_figures(const figures::TransferFunctionData& data,
                                             const std::string& channel) {
  return {figures::transfer_function_figure(data, file_name("transfer-function", channel)),
          figures::deviation_figure(data, file_name("deviation", channel))};
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

std::vector<figures::Figure> interferometer_figures(const RunOutcome& outcome,
                                                    const std::string& source,
                                                    const drivers::SourceDescription& description) {
  std::vector<figures::Figure> drawn;
  for (const drivers::QuadratureSignals& signals : description.quadrature_signals) {
    const std::string channel = source + "/" + signals.channel;
    figures::QuadratureEllipseData data{
        .title = {fmt::format("Interferometer of {}", channel), run_line(outcome)},
        .ellipse = {signals.centre_u1, signals.centre_u2, signals.radius_ratio,
                    signals.quadrature_error_rad, signals.radius_u1},
        .displacement_per_turn_m = signals.displacement_per_turn_m,
        .u_ellipse_rad = signals.u_ellipse_rad,
        .periodic_error_rad = signals.periodic_error_rad,
        .radius_deviation_rel = signals.radius_deviation_rel,
        .below = fmt::format("Ellipse: {}, {:.3g} turns of phase.", signals.ellipse_from,
                             signals.turns_covered)};
    drawn.push_back(figures::quadrature_ellipse_figure(data, file_name("ellipse", channel)));
  }
  return drawn;
}

std::vector<figures::Figure> run_figures(const RunOutcome& outcome, figures::ErrorBars error_bars) {
  std::vector<figures::Figure> drawn;
  for (const TransferFunction& function : outcome.transfer_functions) {
    if (responds(function)) {
      figures::TransferFunctionData data = transfer_data(outcome, function);
      data.error_bars = error_bars;
      for (figures::Figure& figure : channel_figures(data, function.channel)) {
        drawn.push_back(std::move(figure));
      }
    }
  }
  for (const ClockReport& report : outcome.clock_reports) {
    for (figures::Figure& figure : clock_figures(outcome, report)) {
      drawn.push_back(std::move(figure));
    }
  }
  for (const RunSource& source : outcome.sources) {
    for (figures::Figure& figure :
         interferometer_figures(outcome, source.source, source.description)) {
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
    DYNCAL_TRY(const auto written, figures::write(figure, folder));
    paths.insert(paths.end(), written.begin(), written.end());
  }
  if (const std::string closures = closures_csv(outcome); !closures.empty()) {
    DYNCAL_TRY(check_output_folder(folder));
    paths.push_back(folder / "closures.csv");
    DYNCAL_TRY(write_output_file(paths.back(), closures));
  }
  return paths;
}

} // namespace dyncal::inline views
