#include "services/views/report/show_outcome.hpp"

#include <cstdint>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "services/base/output_file.hpp"
#include "services/base/printable_text.hpp"
#include "services/contract/run_identity.hpp"
#include "services/views/report/result_json.hpp"
#include "services/views/report/result_table.hpp"
#include "services/views/report/run_figures.hpp"

namespace dyncal::inline views {
namespace {

std::size_t steps_with_a_result(const RunOutcome& outcome) {
  std::set<std::uint32_t> steps;
  for (const StepResult& result : outcome.results) {
    if (result.valid) {
      steps.insert(result.step);
    }
  }
  return steps.size();
}

// Channels that the run was for and that have no value at any step.
std::vector<std::string> channels_without_a_result(const RunOutcome& outcome) {
  std::set<std::string> without;
  for (const StepResult& result : outcome.results) {
    without.insert(result.channel);
  }
  if (outcome.recipe) {
    for (const ChannelName& channel : outcome.recipe->dut()) {
      without.insert(channel.text());
    }
  }
  for (const StepResult& result : outcome.results) {
    if (result.valid) {
      without.erase(result.channel);
    }
  }
  return {without.begin(), without.end()};
}

} // namespace

namespace {

// Nothing is replaced there: it may be the only file of another run of that name.
std::filesystem::path free_name(const std::filesystem::path& folder, const std::string& stem) {
  std::filesystem::path path = folder / (stem + ".json");
  std::error_code unknown;
  for (int number = 2; std::filesystem::exists(path, unknown); ++number) {
    path = folder / fmt::format("{}-{}.json", stem, number);
  }
  return path;
}

} // namespace

// Results that took hours are not lost with a full disk.
Expected<void> write_results(const RunOutcome& outcome, const std::filesystem::path& path,
                             const RunStatements& stated) {
  const nlohmann::ordered_json json = result_json(outcome, stated);
  auto written = write_json(path, json);
  if (written) {
    return written;
  }
  std::error_code unknown;
  const std::filesystem::path refuge =
      free_name(std::filesystem::temp_directory_path(unknown),
                fmt::format("dyncal-{}-{}", outcome.bench, outcome.run));
  if (!unknown && write_json(refuge, json)) {
    written.error().message += fmt::format("; the results are in {}", refuge.string());
  }
  return written;
}

Expected<void> check_outputs(const std::optional<std::filesystem::path>& json,
                             const FigureFiles& figures) {
  if (json) {
    DYNCAL_TRY(check_output_file(*json));
  }
  return figures.folder ? check_output_folder(*figures.folder) : Expected<void>{};
}

Expected<void> show_outcome(const RunOutcome& outcome,
                            const std::optional<std::filesystem::path>& json,
                            const FigureFiles& figures, const RunStatements& stated) {
  fmt::print("bench {}, run {}{}\n", one_line(outcome.bench),
             one_line(RunIdentity::parse(outcome.run).name), result_table(outcome));
  if (stated.check) {
    fmt::print("{}\n", one_line(sentence_of(*stated.check)));
  }
  if (json) {
    DYNCAL_TRY(write_results(outcome, *json, stated));
  }
  if (figures.folder) {
    DYNCAL_TRY(const auto written, write_figures(outcome, *figures.folder, figures.error_bars));
    for (const std::filesystem::path& path : written) {
      fmt::print("wrote {}\n", path.string());
    }
  }
  return {};
}

std::string output_warning(const RunOutcome& outcome) {
  return outcome.output_is_guarded
             ? "THE OUTPUT OF THE GENERATOR MAY BE ON: it has not confirmed that it is off; switch "
               "it off by hand. A guard goes on trying for ten minutes"
             : "THE OUTPUT OF THE GENERATOR MAY BE ON: nobody has confirmed that it is off; switch "
               "it off at the generator";
}

Expected<void> check_end(const RunOutcome& outcome, const std::string& kept) {
  const std::string end = outcome.interrupted ? "interrupted" : outcome.problem;
  if (outcome.output_may_be_on) {
    return fail(ErrorCode::device, fmt::format("{}{}{}; {}", end, end.empty() ? "" : "; ", kept,
                                               output_warning(outcome)));
  }
  if (outcome.interrupted) {
    return fail(ErrorCode::interrupted, "interrupted: the excitation is off; " + kept);
  }
  if (!outcome.problem.empty()) {
    return fail(ErrorCode::no_result, fmt::format("{}; {}", outcome.problem, kept));
  }
  return {};
}

Expected<void> check_complete(const RunOutcome& outcome) {
  const std::size_t steps = outcome.planned_steps;
  const std::size_t measured = steps_with_a_result(outcome);
  DYNCAL_TRY(
      check_end(outcome, fmt::format("{} of {} steps were measured and kept", measured, steps)));
  if (measured < steps) {
    return fail(ErrorCode::no_result,
                fmt::format("{} of {} steps have no result; the reasons are listed above",
                            steps - measured, steps));
  }
  if (const auto without = channels_without_a_result(outcome); !without.empty()) {
    return fail(ErrorCode::no_result,
                fmt::format("{} of the channels under calibration {} no result at any step: {}; "
                            "the reasons are listed above",
                            without.size(), without.size() == 1 ? "has" : "have",
                            fmt::join(without, ", ")));
  }
  return {};
}

} // namespace dyncal::inline views
