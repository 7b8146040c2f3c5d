// What the laboratory does when a run has ended: the command of the bench file ([run] on_end), with
// the run in its environment. What becomes of it changes nothing of the run, nor its exit status.
#pragma once

#include <filesystem>
#include <string>

#include "services/base/error.hpp"
#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::inline programs {

// DYNCAL_RUN (its name), DYNCAL_BENCH, DYNCAL_STATE ("complete", "incomplete", "interrupted",
// "ended-early") and DYNCAL_FOLDER ("": none). Nothing happens where the bench file names none.
// Fails (bad_file) as run_local_command() does. Blocks up to the limit of the bench file.
[[nodiscard]] Expected<void> run_end_hook(const std::string& bench_text, const RunOutcome& outcome,
                                          const std::filesystem::path& folder);

} // namespace dyncal::inline programs
