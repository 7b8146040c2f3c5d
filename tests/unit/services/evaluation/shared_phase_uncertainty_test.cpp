#include "services/evaluation/shared_phase_uncertainty.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

using analysis::ContributionKind;

double angular(double hz) {
  return 2.0 * std::numbers::pi * hz;
}

SharedPhaseUncertainty shared(ContributionKind kind, const std::function<double(double)>& u_rad) {
  std::vector<BudgetAtFrequency> budgets;
  for (const double hz : {10.0, 40.0, 160.0}) {
    budgets.push_back({hz, {{.kind = kind, .u_phase_rad = u_rad(hz)}}});
  }
  return shared_phase_uncertainty(budgets);
}

TEST(SharedPhaseUncertainty, ADelayOfAllFrequenciesIsCommon) {
  const auto result =
      shared(ContributionKind::adc_phase, [](double hz) { return 2e-7 * angular(hz); });
  EXPECT_NEAR(result.common.delay_s, 2e-7, 1e-18);
  EXPECT_EQ(result.common.phase_rad, 0.0);
  EXPECT_EQ(result.beyond_rad, (std::vector{0.0, 0.0, 0.0}));
}

// 1e-4 rad is 1.6 us at 10 Hz and 0.1 us at 160 Hz: only that can be a delay of all.
TEST(SharedPhaseUncertainty, OfADelayTheLeastIsCommonAndTheRestCountsAtItsFrequency) {
  const auto result = shared(ContributionKind::adc_phase, [](double) { return 1e-4; });
  EXPECT_NEAR(result.common.delay_s, 1e-4 / angular(160.0), 1e-15);
  EXPECT_NEAR(result.beyond_rad[0], 1e-4 * std::sqrt(1.0 - std::pow(10.0 / 160.0, 2)), 1e-12);
  EXPECT_EQ(result.beyond_rad[2], 0.0);
}

TEST(SharedPhaseUncertainty, TheReferenceErrsByAPhaseAndADelay) {
  const auto phase = shared(ContributionKind::reference, [](double) { return 1e-3; });
  EXPECT_NEAR(phase.common.phase_rad, 1e-3, 1e-15);
  EXPECT_EQ(phase.common.delay_s, 0.0);
  const auto both = shared(ContributionKind::reference,
                           [](double hz) { return std::hypot(1e-3, 1e-6 * angular(hz)); });
  EXPECT_NEAR(both.common.phase_rad, 1e-3, 1e-12);
  EXPECT_NEAR(both.common.delay_s, 1e-6, 1e-15);
  EXPECT_EQ(both.beyond_rad, (std::vector{0.0, 0.0, 0.0}));
  const auto dip =
      shared(ContributionKind::reference, [](double hz) { return hz == 40.0 ? 5e-4 : 1e-3; });
  EXPECT_NEAR(dip.common.phase_rad, 5e-4, 1e-15);
  EXPECT_NEAR(dip.beyond_rad[0], std::sqrt(1e-6 - 0.25e-6), 1e-12);
}

TEST(SharedPhaseUncertainty, WhatAveragesIsLeftOut) {
  const auto result = shared(ContributionKind::fit_noise, [](double) { return 1e-3; });
  EXPECT_EQ(result.common.delay_s, 0.0);
  EXPECT_EQ(result.beyond_rad, (std::vector{0.0, 0.0, 0.0}));
  const auto other = shared(ContributionKind::quantisation, [](double) { return 1e-3; });
  EXPECT_NEAR(other.beyond_rad[1], 1e-3, 1e-15);
}

} // namespace
} // namespace dyncal::inline evaluation
