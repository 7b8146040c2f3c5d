// Whether the means of a result file are those of its single results. A mean that somebody else
// published, or that was edited, is not: it would stand in one document, and the single results in
// another.
//
// A file of this version of dyncal must have the means that this version takes
// (evaluation/mean_points.hpp), to 0.01 u. Another version may weigh repetitions otherwise, but
// every mean of phasors lies among them: no farther from their centre than the farthest of them,
// and its u; one without single results is not held against any there. Means that were left out are
// no contradiction, nor is one that is null. Any thread.
#pragma once

#include "services/base/error.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

// Fails (no_result) with the first mean that is none of its single results.
[[nodiscard]] Expected<void> check_means(const StoredResult& result);

} // namespace dyncal::inline views
