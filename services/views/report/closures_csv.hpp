// The closures of a run as CSV, for people with a spreadsheet: a line for each channel and closure.
//
// One header line; numbers with 17 significant digits, those of what is not possible empty; texts
// in quotation marks. Plain function, any thread.
#pragma once

#include <string>

#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::inline views {

// Empty where the run has none.
[[nodiscard]] std::string closures_csv(const RunOutcome& outcome);

} // namespace dyncal::inline views
