#include "services/records/store/migrations.hpp"

#include <functional>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "services/records/store/audit_trail.hpp"

namespace dyncal::inline records {
namespace {

using Change = std::function<Expected<void>(Database&)>;

Expected<void> execute_all(Database& database, const std::vector<std::string>& statements) {
  for (const std::string& statement : statements) {
    DYNCAL_TRY(database.execute(statement));
  }
  return {};
}

Change statements(std::vector<std::string> all) {
  return [all = std::move(all)](Database& database) { return execute_all(database, all); };
}

// Who conducted a run, what is said of it later, and who did what to the store.
Expected<void> add_people_and_audit(Database& database) {
  const auto made = execute_all(
      database,
      {"ALTER TABLE results ADD COLUMN operator TEXT NOT NULL DEFAULT ''",
       "CREATE TABLE run_entries ("
       "entry_sha256 TEXT PRIMARY KEY, bench TEXT NOT NULL, run TEXT NOT NULL, "
       "kind TEXT NOT NULL, at_utc TEXT NOT NULL, entry TEXT NOT NULL)",
       "CREATE INDEX run_entries_by_run ON run_entries (bench, run)",
       "CREATE TABLE audit ("
       "number BIGINT PRIMARY KEY, at_utc TEXT NOT NULL, name TEXT NOT NULL, login TEXT NOT NULL, "
       "host TEXT NOT NULL, action TEXT NOT NULL, subject TEXT NOT NULL, detail TEXT NOT NULL, "
       "previous_sha256 TEXT NOT NULL, sha256 TEXT NOT NULL)"});
  DYNCAL_TRY(made);
  for (const char* table : {"documents", "run_entries", "audit"}) {
    DYNCAL_TRY(database.make_append_only(table));
  }
  return begin_audit(database);
}

const std::vector<Change>& changes() {
  static const std::vector<Change> all{
      statements(
          {"CREATE TABLE results ("
           "result_sha256 TEXT PRIMARY KEY, content_sha256 TEXT NOT NULL, recipe_sha256 TEXT NOT "
           "NULL, "
           "bench TEXT NOT NULL, run TEXT NOT NULL, state TEXT NOT NULL, method TEXT NOT NULL, "
           "began_utc TEXT NOT NULL, ended_utc TEXT NOT NULL, software TEXT NOT NULL, "
           "planned_steps BIGINT NOT NULL, measured_steps BIGINT NOT NULL, problem TEXT NOT NULL, "
           "recipe TEXT NOT NULL, folder TEXT NOT NULL, added_utc TEXT NOT NULL, "
           "document TEXT NOT NULL)",
           "CREATE INDEX results_by_run ON results (bench, run)",
           "CREATE TABLE sources ("
           "result_sha256 TEXT NOT NULL REFERENCES results (result_sha256), source TEXT NOT NULL, "
           "device TEXT NOT NULL, serial TEXT NOT NULL, firmware TEXT NOT NULL, "
           "software TEXT NOT NULL, PRIMARY KEY (result_sha256, source))",
           "CREATE TABLE points ("
           "result_sha256 TEXT NOT NULL REFERENCES results (result_sha256), source TEXT NOT NULL, "
           "channel TEXT NOT NULL, frequency_text_hz TEXT NOT NULL, "
           "frequency_hz DOUBLE PRECISION NOT NULL, level_m_s2 DOUBLE PRECISION, unit TEXT NOT "
           "NULL, "
           "magnitude DOUBLE PRECISION, u_magnitude DOUBLE PRECISION, k_magnitude DOUBLE "
           "PRECISION, "
           "expanded_magnitude DOUBLE PRECISION, phase_rad DOUBLE PRECISION, "
           "u_phase_rad DOUBLE PRECISION, k_phase DOUBLE PRECISION, "
           "expanded_phase_rad DOUBLE PRECISION, flags TEXT NOT NULL)",
           "CREATE INDEX points_of_result ON points (result_sha256)"}),
      statements(
          {"CREATE TABLE samples ("
           "result_sha256 TEXT NOT NULL REFERENCES results (result_sha256), channel TEXT NOT NULL, "
           "step BIGINT NOT NULL, repetition BIGINT NOT NULL, data_sha256 TEXT NOT NULL)",
           "CREATE INDEX samples_of_result ON samples (result_sha256)"}),
      // NULL of samples: not known, of results that were added before.
      statements(
          {"ALTER TABLE points ADD COLUMN excited_axis TEXT NOT NULL DEFAULT ''",
           "ALTER TABLE samples ADD COLUMN frequency_hz DOUBLE PRECISION",
           "ALTER TABLE samples ADD COLUMN level_m_s2 DOUBLE PRECISION",
           "ALTER TABLE samples ADD COLUMN excited_axis TEXT NOT NULL DEFAULT ''",
           "ALTER TABLE samples ADD COLUMN attempt BIGINT",
           "CREATE TABLE closures ("
           "result_sha256 TEXT NOT NULL REFERENCES results (result_sha256), source TEXT NOT NULL, "
           "channel TEXT NOT NULL, kind TEXT NOT NULL, subject TEXT NOT NULL, verdict TEXT NOT "
           "NULL, "
           "found DOUBLE PRECISION, u DOUBLE PRECISION, bound DOUBLE PRECISION, unit TEXT NOT "
           "NULL, "
           "sentence TEXT NOT NULL)",
           "CREATE INDEX closures_of_result ON closures (result_sha256)"}),
      statements({"CREATE TABLE documents ("
                  "document_sha256 TEXT PRIMARY KEY, number TEXT NOT NULL, kind TEXT NOT NULL, "
                  "identifier TEXT NOT NULL, replaces TEXT NOT NULL, issued_utc TEXT NOT NULL, "
                  "result_sha256 TEXT NOT NULL, bench TEXT NOT NULL, run TEXT NOT NULL, serial "
                  "TEXT NOT NULL, "
                  "file TEXT NOT NULL)",
                  "CREATE UNIQUE INDEX documents_by_number ON documents (number, kind)"}),
      add_people_and_audit,
      statements({"CREATE TABLE sensors ("
                  "serial TEXT NOT NULL, version BIGINT NOT NULL, added_utc TEXT NOT NULL, "
                  "file TEXT NOT NULL, PRIMARY KEY (serial, version))"}),
  };
  return all;
}

Expected<int> version_of(Database& database) {
  const auto made =
      database.execute("CREATE TABLE IF NOT EXISTS store_version (version BIGINT NOT NULL)");
  DYNCAL_TRY(made);
  DYNCAL_TRY(const auto rows, database.execute("SELECT MAX(version) FROM store_version"));
  return rows.empty() ? 0 : static_cast<int>(integer_of(rows.front().front()));
}

Expected<void> apply(Database& database, int change) {
  DYNCAL_TRY(changes()[static_cast<std::size_t>(change) - 1](database));
  const auto noted =
      database.execute("INSERT INTO store_version (version) VALUES ($1)", {std::int64_t{change}});
  return noted ? Expected<void>{} : fail(noted.error());
}

} // namespace

int newest_store_version() {
  return static_cast<int>(changes().size());
}

Expected<void> migrate(Database& database, int version) {
  return database.transaction([&]() -> Expected<void> {
    DYNCAL_TRY(const auto now, version_of(database));
    if (now > newest_store_version()) {
      return fail(ErrorCode::bad_file,
                  fmt::format("the store is of version {}, made by a newer dyncal; this one knows "
                              "versions to {}: use the newer one",
                              now, newest_store_version()));
    }
    for (int change = now + 1; change <= version; ++change) {
      DYNCAL_TRY(apply(database, change));
    }
    return {};
  });
}

Expected<std::unique_ptr<Database>> open_migrated(const std::string& place) {
  DYNCAL_TRY(auto database, is_server(place) ? open_postgres(place) : open_sqlite(place));
  if (const auto ready = migrate(*database); !ready) {
    return fail(ready.error().code,
                fmt::format("{}: {}", without_password(place), ready.error().message));
  }
  return database;
}

} // namespace dyncal::inline records
