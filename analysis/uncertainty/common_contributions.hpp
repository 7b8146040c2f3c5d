// Which rows of a budget two results of one bench have in common, whenever they were measured:
// what was calibrated once and corrects both. Their difference does not have these errors, so that
// they must not make it look more uncertain than it is.
//
// It is the source of a row that decides, ContributionKind, never its name. What a kind may have in
// common only in part (folded harmonics, the start of a series) counts as different in each result:
// that hides a small drift rather than alarming for none. Whether two results were really corrected
// by the same calibration is for callers to know. Plain function, any thread.
#pragma once

#include "analysis/uncertainty/contribution.hpp"

namespace dyncal::analysis {

[[nodiscard]] bool is_common_to_results(ContributionKind kind);

} // namespace dyncal::analysis
