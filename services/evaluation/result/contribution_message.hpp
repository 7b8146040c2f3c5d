// A row of the uncertainty budget as the contract's message, and back.
//
// What a program decides by travels as enums; the name goes with it for people. Infinite degrees of
// freedom are infinity in both. A message of a later version may have values that this one does not
// know: such a kind is read as `other` with the name as its subject, such a distribution as normal,
// and what repeats as common, which never averages. Any thread.
#pragma once

#include "analysis/uncertainty/contribution.hpp"
#include "idl/dyncal.h"

namespace dyncal::inline evaluation {

[[nodiscard]] wire::BudgetContribution to_message(const analysis::Contribution& row);
[[nodiscard]] analysis::Contribution from_message(const wire::BudgetContribution& message);

} // namespace dyncal::inline evaluation
