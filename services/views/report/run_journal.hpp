// The journal of a run: what people and the program say of it on the axis of time. Notes, events
// (a pause, a step that was excited again), and amendments, which correct what was stated of the
// run and never what was measured.
//
// It is a file of the run folder, journal.jsonl: a line of JSON an entry, appended whole, never
// changed. The store has the same entries. Fails (bad_file) with file and line for a line that is
// no entry. Any thread; programs that append at once do not mix their lines.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/base/acting_person.hpp"
#include "services/base/error.hpp"
#include "services/views/language/language.hpp"

namespace dyncal::inline views {

inline constexpr const char* journal_file_name = "journal.jsonl";

enum class JournalKind { note, event, amendment };
[[nodiscard]] std::string kind_name(JournalKind kind);

struct AmendedValue {
  std::string key; // "serial"; of a source: "dau/serial"
  std::string before;
  std::string after;
};

struct JournalEntry {
  JournalKind kind = JournalKind::note;
  std::string utc; // "2026-03-01T12:00:00.123456789Z"
  ActingPerson by;
  std::string text;                    // of an amendment: its reason
  std::vector<AmendedValue> changes{}; // of an amendment
};

// Now, by this process.
[[nodiscard]] JournalEntry journal_entry(JournalKind kind, std::string text, ActingPerson by);

// As a line, without its end, and back; `place` is for messages.
[[nodiscard]] std::string line_of(const JournalEntry& entry);
[[nodiscard]] Expected<JournalEntry> journal_entry_of(const std::string& line,
                                                      const std::string& place);

// Empty: there is none.
[[nodiscard]] Expected<std::vector<JournalEntry>>
read_journal(const std::filesystem::path& run_folder);
[[nodiscard]] Expected<void> append_to_journal(const std::filesystem::path& run_folder,
                                               const JournalEntry& entry);

// In the order of time.
void sort_journal(std::vector<JournalEntry>& entries);

// "serial number of dau corrected to 0x2 on 2026-03-02 by A. Meter, was 0x1: typing error"
[[nodiscard]] std::vector<std::string> amendment_sentences(const JournalEntry& entry,
                                                           Language language = Language::english);

} // namespace dyncal::inline views
