#include "analysis/uncertainty/budget.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

TEST(Budget, RowsAddInSquares) {
  Budget budget;
  budget.add({.kind = ContributionKind::reference, .u_magnitude_rel = 3e-3, .u_phase_rad = 5e-3});
  budget.add({.kind = ContributionKind::adc_phase, .u_magnitude_rel = 4e-3, .u_phase_rad = 12e-3});
  EXPECT_DOUBLE_EQ(budget.u_magnitude_rel(), 5e-3);
  EXPECT_DOUBLE_EQ(budget.u_phase_rad(), 13e-3);
}

TEST(Budget, ARowOfNothingIsLeftOut) {
  Budget budget;
  budget.add({.kind = ContributionKind::clock_offset});
  EXPECT_TRUE(budget.rows().empty());
  EXPECT_EQ(budget.u_phase_rad(), 0.0);
}

TEST(Budget, AppendingKeepsTheOrder) {
  Budget first, second;
  first.add({.kind = ContributionKind::rice, .u_magnitude_rel = 1e-3});
  second.add({.kind = ContributionKind::reference, .u_magnitude_rel = 2e-3});
  first.append(second);
  ASSERT_EQ(first.rows().size(), 2u);
  EXPECT_EQ(first.rows()[0].kind, ContributionKind::rice);
  EXPECT_EQ(first.rows()[1].kind, ContributionKind::reference);
}

} // namespace
} // namespace dyncal::analysis
