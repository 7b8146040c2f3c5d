// Results whose uncertainty drawing confirms, for tests.
#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "services/evaluation/result/step_result.hpp"

namespace dyncal::tests {

inline void expect_drawing_agrees(const std::vector<evaluation::StepResult>& results,
                                  std::size_t expected_results) {
  ASSERT_EQ(results.size(), expected_results);
  for (const evaluation::StepResult& result : results) {
    ASSERT_TRUE(result.valid) << result.problem;
    ASSERT_TRUE(result.monte_carlo);
    const analysis::TransferCheck& drawn = *result.monte_carlo;
    EXPECT_NEAR(drawn.magnitude.u / result.u_magnitude, 1.0, 0.05);
    EXPECT_NEAR(drawn.phase_rad.u / result.u_phase_rad, 1.0, 0.05);
    EXPECT_LT(drawn.phase_rad.low, result.phase_rad);
    EXPECT_GT(drawn.phase_rad.high, result.phase_rad);
  }
}

} // namespace dyncal::tests
