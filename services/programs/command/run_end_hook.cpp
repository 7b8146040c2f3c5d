#include "services/programs/command/run_end_hook.hpp"

#include <chrono>

#include "services/bench/file/run_end_table.hpp"
#include "services/contract/run_identity.hpp"
#include "services/programs/command/local_command.hpp"
#include "services/records/store/result_record.hpp"
#include "services/views/report/show_outcome.hpp"

namespace dyncal::inline programs {
namespace {

RunCompletion state_of(const RunOutcome& outcome) {
  if (outcome.interrupted) {
    return RunCompletion::interrupted;
  }
  if (!outcome.problem.empty()) {
    return RunCompletion::ended_early;
  }
  return check_complete(outcome) ? RunCompletion::complete : RunCompletion::incomplete;
}

} // namespace

Expected<void> run_end_hook(const std::string& bench_text, const RunOutcome& outcome,
                            const std::filesystem::path& folder) {
  const auto settings = run_end_settings_of(bench_text);
  if (!settings) {
    return {};
  }
  const std::string place =
      folder.empty() ? "" : std::filesystem::absolute(folder).lexically_normal().string();
  DYNCAL_TRY(
      run_local_command({.words = settings->command,
                         .environment = {{"DYNCAL_RUN", RunIdentity::parse(outcome.run).name},
                                         {"DYNCAL_BENCH", outcome.bench},
                                         {"DYNCAL_STATE", to_string(state_of(outcome))},
                                         {"DYNCAL_FOLDER", place}},
                         .limit = std::chrono::duration_cast<std::chrono::nanoseconds>(
                             std::chrono::duration<double>(settings->limit_s))}));
  return {};
}

} // namespace dyncal::inline programs
