// What the commands show of a run when it is over: the result table, the files asked for, and
// whether every planned step was measured. Belongs to the thread that owns standard output.
#pragma once

#include <filesystem>
#include <optional>

#include "services/error.hpp"
#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::services {

// Prints the table and writes the files asked for. Fails (bad_file) when one cannot be written.
[[nodiscard]] Expected<void> show_outcome(const RunOutcome& outcome,
                                          const std::optional<std::filesystem::path>& json,
                                          const std::optional<std::filesystem::path>& figures);

// Fails (interrupted, no_result) unless every planned step has a valid result, with how many have.
[[nodiscard]] Expected<void> check_complete(const RunOutcome& outcome);

} // namespace dyncal::services
