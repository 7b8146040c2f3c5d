#include "services/evaluation/outcome_agreement.hpp"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/transfer_summary.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::HasSubstr;

StepResult value(std::uint32_t step, double frequency_hz) {
  StepResult result;
  result.channel = "dau/x";
  result.step = step;
  result.repetition = 1;
  result.frequency_hz = frequency_hz;
  result.frequency_text_hz = std::to_string(frequency_hz);
  result.level_m_s2 = 10.0;
  result.valid = true;
  result.magnitude = 1.0 + 1e-3 * step;
  result.u_magnitude = 1e-3;
  result.phase_rad = -1e-3 * frequency_hz;
  result.u_phase_rad = 1e-3;
  result.budget.push_back({.kind = analysis::ContributionKind::fit_noise,
                           .u_magnitude_rel = 1e-3,
                           .u_phase_rad = 1e-3});
  return result;
}

class OutcomeAgreementTest : public testing::Test {
protected:
  RunOutcome run_ = make();

  static RunOutcome make() {
    RunOutcome run;
    run.recipe.emplace();
    for (std::uint32_t step = 1; step <= 3; ++step) {
      run.results.push_back(value(step, 20.0 * step));
    }
    run.transfer_functions = means(run);
    return run;
  }
  static std::vector<TransferFunction> means(const RunOutcome& run) {
    TransferSummary summary(*run.recipe);
    for (const StepResult& result : run.results) {
      summary.add(result);
    }
    return summary.transfer_functions();
  }
};

TEST_F(OutcomeAgreementTest, HoldsForTheSameAndForWhatIsRounded) {
  RunOutcome again = run_;
  again.results[0].magnitude *= 1.0 + 1e-12;
  again.results[1].phase_rad += 2.0 * std::numbers::pi;
  again.results.push_back(value(4, 80.0)); // what was lost live
  const OutcomeAgreement agreement = hold_against(run_, again);
  EXPECT_EQ(agreement.values, 3U);
  EXPECT_EQ(agreement.missing, 0U);
  EXPECT_EQ(agreement.differing, 0U);
  EXPECT_EQ(agreement.difference, "");
  ASSERT_EQ(run_.transfer_functions.size(), 1U);
}

TEST_F(OutcomeAgreementTest, NamesTheFirstValueThatDiffers) {
  for (const double part_of_u : {0.02, 1.0, 1000.0}) {
    RunOutcome again = run_;
    again.results[1].magnitude += part_of_u * 1e-3;
    again.results[2].phase_rad += part_of_u * 1e-3;
    const OutcomeAgreement agreement = hold_against(run_, again);
    EXPECT_EQ(agreement.differing, 2U);
    EXPECT_THAT(agreement.difference, testing::StartsWith("dau/x at 40"));
    EXPECT_THAT(agreement.difference, HasSubstr("(step 2): |H| 1.002, not "));
  }
  RunOutcome again = run_;
  again.results[0].u_phase_rad *= 1.5;
  EXPECT_THAT(hold_against(run_, again).difference, HasSubstr("u of phase"));
}

TEST_F(OutcomeAgreementTest, CountsWhatTheOtherLacks) {
  RunOutcome again = run_;
  again.results[0].valid = false;
  again.results[1].lost = 5;
  again.results[1].magnitude = 0.5;    // of fewer samples
  again.results[2].u_magnitude *= 1.5; // which all steps together make
  const OutcomeAgreement agreement = hold_against(run_, again);
  EXPECT_EQ(agreement.missing, 2U);
  EXPECT_EQ(agreement.differing, 0U);
  EXPECT_EQ(agreement.difference, "");
  again.results[2].magnitude += 1e-3;
  EXPECT_EQ(hold_against(run_, again).differing, 1U);
  again.results.clear();
  EXPECT_EQ(hold_against(run_, again).missing, 3U);
}

// Of an excitation whose first block is not in the recording, as many samples are evaluated, later.
TEST_F(OutcomeAgreementTest, CountsAsMissingWhatIsOfLaterSamples) {
  SourceSamples samples{.source = "acs", .used = 30000};
  samples.first_stamp_ns = 100'000'000;
  samples.last_stamp_ns = 1'599'950'000;
  run_.results[1].samples = {samples};
  RunOutcome again = run_;
  again.results[1].u_magnitude *= 1.5;
  EXPECT_EQ(hold_against(run_, again).differing, 1U) << "of the same samples";
  again.results[1].samples[0].first_stamp_ns += 18'550'000;
  again.results[1].samples[0].last_stamp_ns += 18'550'000;
  const OutcomeAgreement agreement = hold_against(run_, again);
  EXPECT_EQ(agreement.missing, 1U);
  EXPECT_EQ(agreement.differing, 0U);
}

TEST_F(OutcomeAgreementTest, HoldsMeansAndDelaysToo) {
  RunOutcome forged = run_;
  forged.transfer_functions[0].points[1].mean.magnitude = 42.0;
  EXPECT_THAT(hold_against(forged, run_).difference, HasSubstr("mean |H| 42, not 1.002"));
  forged = run_;
  ASSERT_TRUE(forged.transfer_functions[0].group_delay);
  forged.transfer_functions[0].group_delay->delay_s += 1.0;
  EXPECT_THAT(hold_against(forged, run_).difference, HasSubstr("group delay"));
}

TEST_F(OutcomeAgreementTest, PutsTheMeanOfItsPointsInPlaceOfAnother) {
  RunOutcome honest = run_;
  EXPECT_TRUE(replace_foreign_means(honest).empty());
  RunOutcome forged = run_;
  forged.transfer_functions[0].points[1].mean.magnitude = 42.0;
  forged.transfer_functions.push_back(forged.transfer_functions[0]);
  forged.transfer_functions[1].channel = "dau/y"; // without any point
  const auto differences = replace_foreign_means(forged);
  ASSERT_EQ(differences.size(), 2U);
  EXPECT_THAT(differences[1], HasSubstr("dau/y has no valid points"));
  ASSERT_EQ(forged.transfer_functions.size(), 1U);
  EXPECT_DOUBLE_EQ(forged.transfer_functions[0].points[1].mean.magnitude,
                   run_.transfer_functions[0].points[1].mean.magnitude);
}

TEST_F(OutcomeAgreementTest, MeansOfALackingOutcomeAreOfTheResultsThatCame) {
  RunOutcome lacking = run_;
  lacking.transfer_functions[0].flags.push_back(make_flag(ResultFlag::closure_open));
  const std::size_t flags = lacking.transfer_functions[0].flags.size();
  take_means_of_results(lacking);
  ASSERT_EQ(lacking.transfer_functions.size(), 1U);
  EXPECT_EQ(lacking.transfer_functions[0].flags.size(), flags) << "as published where it agrees";

  lacking.results[1].u_magnitude = 0.5e-3; // before the last steps enlarged it
  lacking.results[1].budget[0].u_magnitude_rel = 0.5e-3;
  StepResult other = value(1, 20.0);
  other.channel = "dau/y"; // whose mean has not come
  lacking.results.push_back(other);
  const std::vector<TransferFunction> own = means(lacking);
  take_means_of_results(lacking);
  ASSERT_EQ(lacking.transfer_functions.size(), 2U);
  for (std::size_t i = 0; i < own.size(); ++i) {
    EXPECT_EQ(mean_difference(lacking.transfer_functions[i], own[i]), "");
  }
  EXPECT_NE(mean_difference(lacking.transfer_functions[0], run_.transfer_functions[0]), "");
}

} // namespace
} // namespace dyncal::inline evaluation
