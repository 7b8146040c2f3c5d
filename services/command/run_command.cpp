#include "services/command/run_command.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "drivers/utc_clock.hpp"
#include "services/bench/adc_file.hpp"
#include "services/command/progress_line.hpp"
#include "services/report/run_figures.hpp"
#include "services/report/run_report.hpp"

namespace dyncal::services {
namespace {

std::size_t steps_with_a_result(const RunOutcome& outcome) {
  std::set<std::uint32_t> steps;
  for (const wire::CalibrationResult& result : outcome.results) {
    if (result.valid()) {
      steps.insert(result.step());
    }
  }
  return steps.size();
}

} // namespace

std::string run_from_time() {
  const std::int64_t now_ms = utc_now_ns() / 1'000'000;
  const auto seconds = static_cast<std::time_t>(now_ms / 1000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%S", &utc);
  return fmt::format("{}.{:03}Z", std::string(text.data(), length), now_ms % 1000);
}

Expected<std::vector<analysis::AdcCalibrationPoint>> read_adc_calibration(const BenchFile& bench) {
  if (!bench.corrections.adc) {
    return std::vector<analysis::AdcCalibrationPoint>{};
  }
  return read_adc_file(*bench.corrections.adc);
}

Expected<void> show_outcome(const RunOutcome& outcome,
                            const std::optional<std::filesystem::path>& json,
                            const std::optional<std::filesystem::path>& figures) {
  fmt::print("bench {}, run {}{}\n", outcome.measurement.bench().c_str(),
             outcome.measurement.run().c_str(), result_table(outcome));
  if (json) {
    if (const auto written = write_json(*json, result_json(outcome)); !written) {
      return fail(written.error());
    }
  }
  if (figures) {
    const auto written = write_figures(outcome, *figures);
    if (!written) {
      return fail(written.error());
    }
    for (const std::filesystem::path& path : *written) {
      fmt::print("wrote {}\n", path.string());
    }
  }
  return {};
}

Expected<RunOutcome> conduct_run(const RunCommand& command, const std::stop_token& stop) {
  const auto bench = read_bench_file(command.bench_file);
  if (!bench) {
    return fail(bench.error());
  }
  const auto adc = read_adc_calibration(*bench);
  if (!adc) {
    return fail(adc.error());
  }
  NetworkOptions network = command.network;
  add_network_settings(bench->network, network);
  auto participant = join_network(network, "dyncal-run");
  if (!participant) {
    return fail(participant.error());
  }
  ProgressLine progress(stderr);
  RunController controller(*participant, *bench,
                           command.run.empty() ? run_from_time() : command.run,
                           [&](const RunProgress& state) { progress.show(state); });
  auto outcome = controller.conduct(*adc, stop);
  progress.end();
  if (!outcome) {
    return outcome;
  }
  if (const auto shown = show_outcome(*outcome, command.json, command.figures); !shown) {
    return fail(shown.error());
  }
  return outcome;
}

int conclude(const RunOutcome& outcome) {
  const std::size_t steps = outcome.measurement.steps().size();
  const std::size_t measured = steps_with_a_result(outcome);
  if (outcome.interrupted) {
    return report_error(
        {ErrorCode::interrupted,
         fmt::format("interrupted: the excitation is off; {} of {} steps were measured and kept",
                     measured, steps)});
  }
  if (!outcome.problem.empty()) {
    return report_error(
        {ErrorCode::no_result, fmt::format("{}; {} of {} steps were measured and kept",
                                           outcome.problem, measured, steps)});
  }
  if (measured < steps) {
    return report_error({ErrorCode::no_result,
                         fmt::format("{} of {} steps have no result; the reasons are listed above",
                                     steps - measured, steps)});
  }
  return 0;
}

} // namespace dyncal::services
