// The conditions of a result that combines several runs. Its file has those of each run, one after
// the other; documents state each quantity from the smallest to the largest reading of all runs,
// with the mean of the runs' means (each run is one mounting), the largest U of a reading, and how
// many runs state it. Of a run that was amended the amended value is the only reading. The result
// of one run has each quantity once. Plain functions, any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

[[nodiscard]] std::vector<LoggedCondition> conditions_of_all(const std::vector<StoredResult>& runs);

struct JoinedCondition {
  LoggedCondition logged; // without readings where no run states it
  std::size_t runs = 0;   // that state it
};
// Nothing: no run was to log it.
[[nodiscard]] std::optional<JoinedCondition>
joined_condition(const std::vector<LoggedCondition>& conditions, const std::string& quantity);

} // namespace dyncal::inline views
