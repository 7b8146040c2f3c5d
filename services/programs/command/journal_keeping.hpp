// An entry into the journal of a run: its folder first, then the store. Belongs to one thread.
#pragma once

#include <filesystem>

#include "services/base/error.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/views/report/run_journal.hpp"

namespace dyncal::inline programs {

// Fails (bad_argument) for what is no folder with a result.
[[nodiscard]] Expected<void> check_run_folder(const std::filesystem::path& run);

// Fails (bad_file) where the folder takes no entry, and where the store does not, which is said,
// with how to add it later.
[[nodiscard]] Expected<void> keep_entry(const std::filesystem::path& run, const StorePlace& store,
                                        const JournalEntry& entry);

} // namespace dyncal::inline programs
