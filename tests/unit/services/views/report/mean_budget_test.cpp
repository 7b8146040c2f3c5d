#include "services/views/report/mean_budget.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "services/evaluation/mean_points.hpp"
#include "services/views/report/result_json.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline views {
namespace {

using analysis::Contribution;
using analysis::ContributionKind;

StepResult single(std::uint32_t repetition, double magnitude, double u_noise) {
  StepResult result = tests::example_result(repetition, "10");
  result.repetition = repetition;
  result.valid = true;
  result.magnitude = magnitude;
  result.phase_rad = -0.5;
  result.budget = {
      {.kind = ContributionKind::reference, .u_magnitude_rel = 1e-3, .u_phase_rad = 2e-3},
      {.kind = ContributionKind::fit_noise,
       .subject = "the sensor",
       .degrees_of_freedom = 17.0,
       .u_magnitude_rel = u_noise,
       .u_phase_rad = u_noise},
      {.kind = ContributionKind::stamp_jitter,
       .subject = "the sensor",
       .u_magnitude_rel = 5e-4,
       .u_phase_rad = 1e-4,
       .u_lasting_magnitude_rel = 3e-4}};
  return result;
}

StoredResult result_of(const std::vector<StepResult>& singles) {
  RunOutcome outcome = tests::example_outcome();
  outcome.results = singles;
  std::vector<const StepResult*> pointers;
  for (const StepResult& result : outcome.results) {
    pointers.push_back(&result);
  }
  outcome.transfer_functions.resize(1);
  outcome.transfer_functions.front().points = mean_points(pointers);
  return stored_result_of(outcome);
}

// Two repetitions with u of noise of 3e-3 and 4e-3, which agree.
TEST(MeanBudget, AveragesWhatIsDrawnAnewAndNothingElse) {
  StoredResult result = result_of({single(1, 1.0, 3e-3), single(2, 1.0, 4e-3)});
  ASSERT_EQ(result.values.size(), 1U);
  StoredValue& mean = result.values.front();
  // 1e-6 of the reference, 25e-6 / 4 of noise, 9e-8 + (25e-8 - 9e-8) / 2 of stamps
  const double u2 = 1e-6 + 6.25e-6 + 9e-8 + 8e-8;
  mean.of_magnitude.u = mean.magnitude * std::sqrt(u2);
  mean.of_phase.u = std::sqrt(4e-6 + 6.25e-6 + 0.5e-8 + 1.6e-5);
  const std::vector<Contribution> rows = budget_of_mean(result, mean);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_NEAR(rows[0].u_magnitude_rel, 1e-3, 1e-12);
  EXPECT_NEAR(rows[0].u_phase_rad, 2e-3, 1e-12);
  EXPECT_NEAR(rows[1].u_magnitude_rel, 2.5e-3, 1e-12);
  EXPECT_NEAR(rows[1].degrees_of_freedom, 34.0, 1e-12);
  EXPECT_NEAR(rows[2].u_magnitude_rel, std::sqrt(17e-8), 1e-12);
  EXPECT_EQ(rows[3].u_magnitude_rel, 0.0) << "u of the magnitude is that of the rows";
  EXPECT_NEAR(rows[3].u_phase_rad, 4e-3, 1e-9);
  EXPECT_EQ(rows[3].name(), "scatter of the repetitions beyond their budgets");
}

// U / k of real means, whose repetitions scatter more than their budgets state, or less.
TEST(MeanBudget, AddsUpToTheUncertaintyOfTheMean) {
  std::mt19937 draw(20261127);
  for (const double scatter : {1e-4, 1e-3, 2e-2}) {
    std::normal_distribution<double> noise(0.0, scatter);
    std::vector<StepResult> singles;
    for (std::uint32_t repetition = 1; repetition <= 5; ++repetition) {
      singles.push_back(single(repetition, 1.0 + noise(draw), 1e-3));
    }
    const StoredResult result = result_of(singles);
    ASSERT_EQ(result.values.size(), 1U);
    const StoredValue& mean = result.values.front();
    double magnitude2 = 0.0;
    double phase2 = 0.0;
    for (const Contribution& row : budget_of_mean(result, mean)) {
      magnitude2 += row.u_magnitude_rel * row.u_magnitude_rel;
      phase2 += row.u_phase_rad * row.u_phase_rad;
    }
    const double u = mean.of_magnitude.expanded / mean.of_magnitude.k / mean.magnitude;
    EXPECT_NEAR(std::sqrt(magnitude2) / u, 1.0, 1e-3) << scatter;
    EXPECT_NEAR(std::sqrt(phase2) / (mean.of_phase.expanded / mean.of_phase.k), 1.0, 1e-3);
  }
}

TEST(MeanBudget, IsNotKnownWithoutSingleResults) {
  StoredResult result = result_of({single(1, 1.0, 3e-3)});
  const StoredValue mean = result.values.front();
  EXPECT_FALSE(budget_of_mean(result, mean).empty());
  result.points.clear();
  EXPECT_TRUE(budget_of_mean(result, mean).empty());
}

} // namespace
} // namespace dyncal::inline views
