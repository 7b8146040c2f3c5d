// Amendments of a run applied to what documents and lists show of it: what was stated of the run
// takes its new value, what was measured stays as it is. The keys are those that a document states
// and nobody measures; a sensor's serial number and model are of a source: "dau/serial".
//
// Plain functions, any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

// "serial", "operator", ... as they stand in the guide.
[[nodiscard]] const std::vector<std::string>& amendable_keys();

// KEY=VALUE as a person types it, with what the run states now. "serial" and "model" are those of
// the only source under calibration. Fails (bad_argument) for a key that is not known, an ambiguous
// source, a value that the key does not take, and one that is there already.
[[nodiscard]] Expected<AmendedValue> amended_value(const StoredResult& result,
                                                   const std::string& assignment);

// The newest value that the journal gives a key; nothing: none does.
[[nodiscard]] std::optional<std::string> amended(const std::vector<JournalEntry>& journal,
                                                 const std::string& key);

// Sources, operator and comment take their amended values; the journal is kept in the result.
void add_journal(std::vector<JournalEntry> journal, StoredResult& result);
// The same for sources alone.
void amend_sources(const std::vector<JournalEntry>& journal, std::vector<RunSource>& sources);

// A sentence a change, the oldest first.
[[nodiscard]] std::vector<std::string> amendment_sentences(const std::vector<JournalEntry>& journal,
                                                           Language language = Language::english);

} // namespace dyncal::inline views
