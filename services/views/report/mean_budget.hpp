// The budget of a mean over repetitions, whose U documents state: made of the budgets of its single
// results.
//
//   row that is drawn anew in each of n    sqrt(sum u_i^2) / n, but its lasting part as the next
//   row that is common                     sqrt(sum u_i^2 / n)
//   scatter beyond that                    what u of the mean has more than all of them:
//   repetitions
//                                          scatter more than their budgets state, or all
//                                          frequencies together say so
//                                          (analysis/method/repetitions.hpp)
//
// Rows add in squares to u of the mean, which is U / k; to somewhat more where the sensor hardly
// stands out of noise, as only the mean tells its amplitude then. Of the magnitude they are
// relative to that of the mean. A row of n that are drawn anew has n times its degrees of freedom.
// Plain function, any thread.
#pragma once

#include <vector>

#include "analysis/uncertainty/contribution.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

// Empty: the result has no single results of that mean.
[[nodiscard]] std::vector<analysis::Contribution> budget_of_mean(const StoredResult& result,
                                                                 const StoredValue& value);

} // namespace dyncal::inline views
