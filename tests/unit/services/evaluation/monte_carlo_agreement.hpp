// Results whose uncertainty drawing confirms, for tests.
#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "idl/dyncal.h"

namespace dyncal::tests {

inline void expect_drawing_agrees(const std::vector<wire::CalibrationResult>& results,
                                  std::size_t expected_results) {
  ASSERT_EQ(results.size(), expected_results);
  for (const wire::CalibrationResult& result : results) {
    ASSERT_TRUE(result.valid()) << result.problem();
    ASSERT_EQ(result.monte_carlo().size(), 1U);
    const wire::MonteCarloCheck& check = result.monte_carlo().front();
    EXPECT_NEAR(check.u_magnitude() / result.u_magnitude(), 1.0, 0.05);
    EXPECT_NEAR(check.u_phase_rad() / result.u_phase_rad(), 1.0, 0.05);
    EXPECT_LT(check.phase_low_rad(), result.phase_rad());
    EXPECT_GT(check.phase_high_rad(), result.phase_rad());
  }
}

} // namespace dyncal::tests
