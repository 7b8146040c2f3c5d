// One result file of several runs of one sensor that was mounted anew for each of them
// (services/evaluation/combined_mountings.hpp), which has a certificate of its own.
//
// Runs belong together if they have the method, the channels with their units, the sources of the
// channels with their serial numbers, and the excited axis in common; points that one of them lacks
// are left out. Flags of any run stay, and conditions are those of all (combined_conditions.hpp).
// Its single results are the means of the mountings, so that it is held against them as any other
// result file; `combined` names the runs with their SHA-256.
//
// Fails (bad_argument): fewer than two runs, one twice, runs that do not belong together, one that
// was interrupted or ended early, no point in common. Any thread.
#pragma once

#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

// `name`: of the combined run.
[[nodiscard]] Expected<StoredResult> combined_result(const std::vector<StoredResult>& runs,
                                                     const std::string& name);

} // namespace dyncal::inline views
