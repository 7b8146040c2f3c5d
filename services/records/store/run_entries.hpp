// The journals of runs (views/report/run_journal.hpp) in the tables of a store, an entry a row,
// known by the SHA-256 of its line. Writing needs a transaction of the caller, and goes into the
// audit trail. Fails (bad_file) as databases do. Any thread, as the database.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "services/base/acting_person.hpp"
#include "services/base/error.hpp"
#include "services/records/store/database.hpp"
#include "services/views/report/run_journal.hpp"

namespace dyncal::inline records {

// Those that are not there yet.
[[nodiscard]] Expected<void> insert_entries(Database& database, const std::string& bench,
                                            const std::string& run,
                                            const std::vector<JournalEntry>& entries,
                                            const ActingPerson& by);
// In the order of time.
[[nodiscard]] Expected<std::vector<JournalEntry>>
entries_of(Database& database, const std::string& bench, const std::string& run);

// Amendments alone, by bench and run.
using JournalsByRun = std::map<std::pair<std::string, std::string>, std::vector<JournalEntry>>;
[[nodiscard]] Expected<JournalsByRun> amendments_by_run(Database& database);

} // namespace dyncal::inline records
