#include "services/records/store/run_entries.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/contract/digest.hpp"
#include "services/records/store/audit_trail.hpp"

namespace dyncal::inline records {

Expected<void> insert_entries(Database& database, const std::string& bench, const std::string& run,
                              const std::vector<JournalEntry>& entries, const ActingPerson& by) {
  for (const JournalEntry& entry : entries) {
    const std::string line = line_of(entry);
    const std::string sha256 = sha256_hex(line);
    DYNCAL_TRY(const auto known,
               database.execute("SELECT run FROM run_entries WHERE entry_sha256 = $1", {sha256}));
    if (!known.empty()) {
      continue;
    }
    DYNCAL_TRY(
        database.execute("INSERT INTO run_entries (entry_sha256, bench, run, kind, at_utc, entry) "
                         "VALUES ($1, $2, $3, $4, $5, $6)",
                         {sha256, bench, run, kind_name(entry.kind), entry.utc, line}));
    const bool is_amendment = entry.kind == JournalKind::amendment;
    DYNCAL_TRY(add_to_audit(
        database,
        {is_amendment ? AuditAction::run_amended : AuditAction::note_added, sha256,
         fmt::format("{} of run {} of bench {}: {}", kind_name(entry.kind), run, bench,
                     is_amendment ? fmt::format("{}", fmt::join(amendment_sentences(entry), "; "))
                                  : entry.text)},
        by));
  }
  return {};
}

Expected<std::vector<JournalEntry>> entries_of(Database& database, const std::string& bench,
                                               const std::string& run) {
  DYNCAL_TRY(const auto rows, database.execute("SELECT entry FROM run_entries WHERE bench = $1 "
                                               "AND run = $2 ORDER BY at_utc, entry_sha256",
                                               {bench, run}));
  std::vector<JournalEntry> entries;
  for (const DatabaseRow& row : rows) {
    DYNCAL_TRY(auto entry, journal_entry_of(text_of(row[0]), "an entry in the store"));
    entries.push_back(std::move(entry));
  }
  return entries;
}

Expected<JournalsByRun> amendments_by_run(Database& database) {
  DYNCAL_TRY(const auto rows, database.execute("SELECT bench, run, entry FROM run_entries WHERE "
                                               "kind = 'amendment' ORDER BY at_utc"));
  JournalsByRun journals;
  for (const DatabaseRow& row : rows) {
    DYNCAL_TRY(auto entry, journal_entry_of(text_of(row[2]), "an amendment in the store"));
    journals[{text_of(row[0]), text_of(row[1])}].push_back(std::move(entry));
  }
  return journals;
}

} // namespace dyncal::inline records
