// Whether the means of a result file are those of its single results. A mean that somebody else
// published, or that was edited, is not: it would stand in one document, and the single results in
// another.
//
// A file of this version of dyncal must have the means that this version takes
// (evaluation/mean_points.hpp), to 0.01 u. Another version may weigh repetitions otherwise, but
// every mean of phasors lies among them: no farther from their centre than the farthest of them,
// and its u. Any thread.
#pragma once

#include <optional>
#include <string>

#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

// The first mean that is none of its single results; nothing: there is no such.
[[nodiscard]] std::optional<std::string> foreign_mean(const StoredResult& result);

} // namespace dyncal::inline views
