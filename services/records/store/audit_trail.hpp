// The audit trail of a store: who did what to it, when and from where. Entries are appended, never
// changed: the database refuses it, and each entry has the SHA-256 of the one before and of itself,
// so that what was changed all the same, or taken out, breaks the chain.
//
// sha256 is that of "PREVIOUS\n" and then, for each of number, at_utc, name, user, host, action,
// subject and detail, "BYTES:TEXT\n". The first entry has no previous one ("").
//
// What the chain alone cannot show is that its last entries are gone; note its head now and then,
// and ask for it. Functions that write need a transaction of the caller. Fails (bad_file) as
// databases do. Any thread, as the database.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/base/acting_person.hpp"
#include "services/base/error.hpp"
#include "services/records/store/database.hpp"

namespace dyncal::inline records {

// What happens in a store.
enum class AuditAction {
  store_found, // the trail begins in a store that was there: a result or document of it
  result_added,
  result_removed, // of a run that had not ended, for the one that has
  document_issued,
  note_added,
  run_amended,
  sensor_changed
};
[[nodiscard]] std::string to_string(AuditAction action);

struct AuditEvent {
  AuditAction action = AuditAction::result_added;
  std::string subject; // SHA-256 of a result, a document, an entry, or a version of a sensor's file
  std::string detail;  // for people
};

struct AuditEntry {
  std::int64_t number = 0; // 1, 2, ...
  std::string at_utc;
  ActingPerson by;
  std::string action;
  std::string subject;
  std::string detail;
  std::string previous_sha256;
  std::string sha256;
};

[[nodiscard]] Expected<void> add_to_audit(Database& database, const AuditEvent& event,
                                          const ActingPerson& by);
// All, the oldest first.
[[nodiscard]] Expected<std::vector<AuditEntry>> audit_entries(Database& database);

// Of a version of a sensor's file: "SERIAL\nVERSION\nFILE".
[[nodiscard]] std::string sensor_hash(const std::string& serial, std::int64_t version,
                                      const std::string& file);

// What is wrong, a sentence each; empty: chain and tables agree. Results, documents, entries of
// journals and files of sensors are held against the trail, and the texts that are kept against
// their SHA-256.
[[nodiscard]] Expected<std::vector<std::string>> audit_problems(Database& database);

// Results and documents that are in the store before there is a trail.
[[nodiscard]] Expected<void> begin_audit(Database& database);

} // namespace dyncal::inline records
