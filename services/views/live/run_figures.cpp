#include "services/views/live/run_figures.hpp"

#include <utility>

#include "services/contract/channel_name.hpp"
#include "services/views/report/run_figures.hpp"
#include "services/views/report/transfer_data.hpp"

namespace dyncal::inline views::live {
namespace {

// As files are made of it, but with the results of one channel.
RunOutcome outcome_of(const network::Bench& bench, const network::Run& run,
                      const std::string& channel) {
  RunOutcome outcome;
  outcome.bench = bench.name;
  outcome.run = run.name;
  for (const auto& [key, result] : run.results) {
    if (result.channel == channel) {
      outcome.results.push_back(result);
    }
  }
  return outcome;
}

} // namespace

std::vector<figures::Figure> run_figures(const network::Bench& bench, const network::Run& run,
                                         const std::string& channel,
                                         figures::ErrorBars error_bars) {
  const RunOutcome outcome = outcome_of(bench, run, channel);
  const auto function = run.transfer_functions.find(channel);
  const bool has_means =
      function != run.transfer_functions.end() && !function->second.points.empty();
  if (outcome.results.empty() && !has_means) {
    return {};
  }
  figures::TransferFunctionData data =
      has_means ? transfer_data(outcome, function->second) : transfer_data_so_far(outcome, channel);
  data.error_bars = error_bars;
  std::vector<figures::Figure> drawn = channel_figures(data, channel);
  const auto name = parse_channel_name(channel);
  const auto report = name ? run.clock_reports.find(name->source) : run.clock_reports.end();
  if (report != run.clock_reports.end()) {
    for (figures::Figure& figure : clock_figures(outcome, report->second)) {
      drawn.push_back(std::move(figure));
    }
  }
  const bool is_current = &run == bench.current_run();
  for (const auto& [source_name, source] : bench.sources) {
    if (is_current && source.description) {
      for (figures::Figure& figure :
           interferometer_figures(outcome, source_name, *source.description)) {
        drawn.push_back(std::move(figure));
      }
    }
  }
  return drawn;
}

} // namespace dyncal::inline views::live
