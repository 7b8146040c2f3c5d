// The check of the bench that a run rests on, where the bench demands one: the newest result of the
// check sensor, or why the run was made without. Who conducts the run states it; it stands in the
// result file beside what was evaluated, as "check" (result.schema.json). Plain data; any thread.
#pragma once

#include <string>

#include "services/views/language/language.hpp"

namespace dyncal::inline views {

struct DailyCheck {
  std::string sensor;
  std::string run;       // of the check; empty: this run is the check itself, or none was asked for
  std::string began_utc; // of that run
  std::string state;     // "in control", as the control chart says
  std::string left_out;  // why there was none; empty: there was
};

// For tables and documents.
[[nodiscard]] std::string sentence_of(const DailyCheck& check,
                                      Language language = Language::english);

} // namespace dyncal::inline views
