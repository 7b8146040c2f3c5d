// The conditions that a document states, and where each of them is from: measured over the run
// where a logger did so, else as laboratory or sensor file have them, which somebody typed; an
// amendment of the run takes the place of either.
//
// A measured condition is the mean over the run, with an expanded uncertainty that covers a reading
// and how far it went. Plain functions, any thread.
#pragma once

#include <string>
#include <vector>

#include "services/views/lab_file/contact_table.hpp"
#include "services/views/lab_file/sensor_file.hpp"
#include "services/views/language/sentence.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct DocumentedConditions {
  Conditions conditions;
  std::vector<TranslatedText> origins; // a sentence each
};

[[nodiscard]] DocumentedConditions documented_conditions(const StoredResult& result,
                                                         const Conditions& typed);

// What the journal of the run corrects of a sensor file, and of who the customer is.
void amend(const std::vector<JournalEntry>& journal, SensorFile& sensor);
void amend(const std::vector<JournalEntry>& journal, Contact& customer);

} // namespace dyncal::inline views
