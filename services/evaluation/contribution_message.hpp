// A row of the uncertainty budget as the contract's message, and back: the one place that knows
// how.
//
// The message has no kind yet: it is told from the name, and what repeats follows from the kind.
// Infinite degrees of freedom are 0 in the message alone. A row that was drawn anew does not say
// there how much of its magnitude lasts over repetitions; for stamp noise, which has such a part,
// all of it is then taken to last. Any thread.
#pragma once

#include "analysis/uncertainty/contribution.hpp"
#include "idl/dyncal.h"

namespace dyncal::services {

[[nodiscard]] wire::BudgetContribution contribution_message(const analysis::Contribution& row);
[[nodiscard]] analysis::Contribution contribution_of(const wire::BudgetContribution& message);

} // namespace dyncal::services
