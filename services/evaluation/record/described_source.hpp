// Whether a source that has described itself has what the recipe wants of it: its channels, of the
// quantities that their roles have, and samples often enough for every planned frequency.
//
// A description that lacks it is refused with one sentence; code no_source. Plain functions; the
// caller's thread.
#pragma once

#include "services/base/error.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/run_records.hpp"

namespace dyncal::inline evaluation {

// Quantities are those of all channels that are described so far: the last source to describe
// itself completes them.
[[nodiscard]] Expected<void> check_source(const Recipe& recipe, const RunRecords& records,
                                          const SourceRecord& source);

// Drops the channels that the recipe does not name.
void keep_needed_channels(const Recipe& recipe, SourceRecord& source);

} // namespace dyncal::inline evaluation
