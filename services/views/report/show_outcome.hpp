// What the commands show of a run when it is over: the result table, the files asked for, and
// whether every planned step was measured. Belongs to the thread that owns standard output.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "services/base/error.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/views/report/run_figures.hpp"
#include "services/views/report/run_statements.hpp"

namespace dyncal::inline views {

// Before the run: fails (bad_file) when what show_outcome() is to write could not be written now.
[[nodiscard]] Expected<void> check_outputs(const std::optional<std::filesystem::path>& json,
                                           const FigureFiles& figures);

// Prints the table, what the check of the bench says, and writes the files asked for. Fails
// (bad_file) when one cannot be written; the results are then kept in the folder for temporary
// files, if they can be, and the error says so.
[[nodiscard]] Expected<void> show_outcome(const RunOutcome& outcome,
                                          const std::optional<std::filesystem::path>& json,
                                          const FigureFiles& figures,
                                          const RunStatements& stated = {});

// Writes the JSON file. Fails as show_outcome() does, with the results in the same refuge.
[[nodiscard]] Expected<void> write_results(const RunOutcome& outcome,
                                           const std::filesystem::path& path,
                                           const RunStatements& stated = {});

// What to say last where RunOutcome::output_may_be_on: what is dangerous, and what to do.
[[nodiscard]] std::string output_warning(const RunOutcome& outcome);

// Fails when the run has not come to its planned end: device when the generator's output may be on,
// else interrupted, no_result. `kept` says what has become of its results.
[[nodiscard]] Expected<void> check_end(const RunOutcome& outcome, const std::string& kept);

// Fails as check_end() does, and (no_result) unless every planned step and every channel under
// calibration has a valid result, with those that have none.
[[nodiscard]] Expected<void> check_complete(const RunOutcome& outcome);

} // namespace dyncal::inline views
