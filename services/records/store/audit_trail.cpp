#include "services/records/store/audit_trail.hpp"

#include <ctime>
#include <map>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "services/base/per_enumerator.hpp"
#include "services/contract/digest.hpp"

namespace dyncal::inline records {
namespace {

constexpr std::size_t shown_of_hash = 12;

std::string hash_of(const AuditEntry& entry) {
  std::string text = entry.previous_sha256 + '\n';
  for (const std::string& part :
       {std::to_string(entry.number), entry.at_utc, entry.by.name, entry.by.user, entry.by.host,
        entry.action, entry.subject, entry.detail}) {
    text += fmt::format("{}:{}\n", part.size(), part);
  }
  return sha256_hex(text);
}

AuditEntry entry_of(const DatabaseRow& row) {
  return {.number = integer_of(row[0]),
          .at_utc = text_of(row[1]),
          .by = {text_of(row[2]), text_of(row[3]), text_of(row[4])},
          .action = text_of(row[5]),
          .subject = text_of(row[6]),
          .detail = text_of(row[7]),
          .previous_sha256 = text_of(row[8]),
          .sha256 = text_of(row[9])};
}

constexpr const char* select_entries =
    "SELECT number, at_utc, name, login, host, action, subject, detail, previous_sha256, sha256 "
    "FROM audit ORDER BY number";

void check_chain(const std::vector<AuditEntry>& entries, std::vector<std::string>& problems) {
  std::string previous;
  std::int64_t number = 0;
  for (const AuditEntry& entry : entries) {
    if (entry.number != ++number) {
      problems.push_back(fmt::format("entry {} is missing", number));
      number = entry.number;
    }
    if (entry.previous_sha256 != previous) {
      problems.push_back(fmt::format("entry {} does not follow the one before", entry.number));
    }
    if (entry.sha256 != hash_of(entry)) {
      problems.push_back(fmt::format("entry {} of {} ({}, {}) was changed", entry.number,
                                     entry.at_utc, entry.action, entry.detail));
    }
    previous = entry.sha256;
  }
}

// A table whose rows have entries, and the text that a row's SHA-256 is of; empty: it is not kept.
struct AuditedTable {
  const char* name;
  const char* hash_column;
  const char* text_column;
  const char* kind; // of a row, for sentences
};
constexpr AuditedTable audited_tables[] = {
    {"results", "result_sha256", "document", "result"},
    {"documents", "document_sha256", "", "document"},
    {"run_entries", "entry_sha256", "entry", "journal entry"}};

// What should be in the tables: subjects of entries about rows, with the last one's detail.
std::map<std::string, std::string> expected_rows(const std::vector<AuditEntry>& entries) {
  std::map<std::string, std::string> rows;
  for (const AuditEntry& entry : entries) {
    if (entry.action == to_string(AuditAction::result_removed)) {
      rows.erase(entry.subject);
    } else {
      rows[entry.subject] = entry.detail;
    }
  }
  return rows;
}

Expected<void> check_table(Database& database, const AuditedTable& table,
                           std::map<std::string, std::string>& expected,
                           std::vector<std::string>& problems) {
  const std::string text = *table.text_column == '\0' ? "''" : table.text_column;
  DYNCAL_TRY(const auto rows,
             database.execute(fmt::format("SELECT {}, {} FROM {} ORDER BY {}", table.hash_column,
                                          text, table.name, table.hash_column)));
  for (const DatabaseRow& row : rows) {
    const std::string hash = text_of(row[0]);
    if (expected.erase(hash) == 0) {
      problems.push_back(fmt::format("a {} (SHA-256 {}...) is in the store, and not in its trail",
                                     table.kind, hash.substr(0, shown_of_hash)));
    }
    if (*table.text_column != '\0' && sha256_hex(text_of(row[1])) != hash) {
      problems.push_back(fmt::format("the text of a {} (SHA-256 {}...) was changed in the store",
                                     table.kind, hash.substr(0, shown_of_hash)));
    }
  }
  return {};
}

Expected<void> check_sensors(Database& database, std::map<std::string, std::string>& expected,
                             std::vector<std::string>& problems) {
  DYNCAL_TRY(const auto rows, database.execute("SELECT serial, version, file FROM sensors "
                                               "ORDER BY serial, version"));
  for (const DatabaseRow& row : rows) {
    const std::string serial = text_of(row[0]);
    const std::int64_t version = integer_of(row[1]);
    if (expected.erase(sensor_hash(serial, version, text_of(row[2]))) == 0) {
      problems.push_back(fmt::format("version {} of the file of sensor {} is not in the trail, or "
                                     "was changed in the store",
                                     version, serial));
    }
  }
  return {};
}

Expected<void> add_found(Database& database, const std::string& statement) {
  DYNCAL_TRY(const auto rows, database.execute(statement));
  for (const DatabaseRow& row : rows) {
    DYNCAL_TRY(add_to_audit(database,
                            {AuditAction::store_found, text_of(row[0]),
                             fmt::format("{} of run {} of bench {}", text_of(row[1]),
                                         text_of(row[2]), text_of(row[3]))},
                            acting_person()));
  }
  return {};
}

} // namespace

std::string to_string(AuditAction action) {
  return per_enumerator(action, {"store_found", "result_added", "result_removed", "document_issued",
                                 "note_added", "run_amended", "sensor_changed"});
}

std::string sensor_hash(const std::string& serial, std::int64_t version, const std::string& file) {
  return sha256_hex(fmt::format("{}\n{}\n{}", serial, version, file));
}

Expected<void> add_to_audit(Database& database, const AuditEvent& event, const ActingPerson& by) {
  DYNCAL_TRY(const auto newest, database.execute("SELECT number, sha256 FROM audit ORDER BY number "
                                                 "DESC LIMIT 1"));
  AuditEntry entry{.number = newest.empty() ? 1 : integer_of(newest[0][0]) + 1,
                   .at_utc = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))),
                   .by = by,
                   .action = to_string(event.action),
                   .subject = event.subject,
                   .detail = event.detail,
                   .previous_sha256 = newest.empty() ? "" : text_of(newest[0][1]),
                   .sha256 = {}};
  entry.sha256 = hash_of(entry);
  DYNCAL_TRY(database.execute(
      "INSERT INTO audit (number, at_utc, name, login, host, action, subject, detail, "
      "previous_sha256, sha256) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10)",
      {entry.number, entry.at_utc, entry.by.name, entry.by.user, entry.by.host, entry.action,
       entry.subject, entry.detail, entry.previous_sha256, entry.sha256}));
  return {};
}

Expected<std::vector<AuditEntry>> audit_entries(Database& database) {
  DYNCAL_TRY(const auto rows, database.execute(select_entries));
  std::vector<AuditEntry> entries;
  for (const DatabaseRow& row : rows) {
    entries.push_back(entry_of(row));
  }
  return entries;
}

Expected<std::vector<std::string>> audit_problems(Database& database) {
  DYNCAL_TRY(const auto entries, audit_entries(database));
  std::vector<std::string> problems;
  check_chain(entries, problems);
  std::map<std::string, std::string> expected = expected_rows(entries);
  for (const AuditedTable& table : audited_tables) {
    DYNCAL_TRY(check_table(database, table, expected, problems));
  }
  DYNCAL_TRY(check_sensors(database, expected, problems));
  for (const auto& [subject, detail] : expected) {
    problems.push_back(fmt::format("what the trail has is not in the store any more: {} (SHA-256 "
                                   "{}...)",
                                   detail, subject.substr(0, shown_of_hash)));
  }
  return problems;
}

Expected<void> begin_audit(Database& database) {
  return add_found(database, "SELECT result_sha256, 'result', run, bench FROM results "
                             "ORDER BY added_utc, result_sha256")
      .and_then([&] {
        return add_found(database, "SELECT document_sha256, number, run, bench FROM documents "
                                   "ORDER BY issued_utc, document_sha256");
      });
}

} // namespace dyncal::inline records
