#include "services/views/report/transfer_data.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "services/views/report/expanded_uncertainty.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline views {
namespace {

constexpr double turn = 2 * std::numbers::pi;

StepResult valid_result(std::uint32_t step, const std::string& frequency_hz, double magnitude,
                        double phase_rad) {
  StepResult result = tests::example_result(step, frequency_hz);
  result.valid = true;
  result.unit = R"(\one)";
  result.magnitude = magnitude;
  result.u_magnitude = 1e-3;
  result.phase_rad = phase_rad;
  result.u_phase_rad = 2e-3;
  return result;
}

// Two repetitions at 10 Hz on both sides of half a turn, one at 20 Hz; one result is not valid and
// one is of another channel.
RunOutcome lasting_run() {
  RunOutcome outcome;
  outcome.bench = "acc-1";
  outcome.run = "r1";
  outcome.results = {valid_result(1, "10", 1.0, 3.1), valid_result(2, "20", 2.0, 2.0),
                     valid_result(3, "10", 1.2, -3.1), valid_result(4, "20", 9.0, 0.0),
                     tests::example_result(5, "30")};
  outcome.results[2].repetition = 2;
  outcome.results[2].flags = {flag_of_source(ResultFlag::samples_lost, "dau")};
  outcome.results[3].channel = "dau/other";
  outcome.results[0].signals = {{.channel = "acs/sync", .residual = 0.5},
                                {.channel = "dau/acceleration_z", .residual = 0.01}};
  return outcome;
}

TEST(TransferDataSoFar, AveragesValidRepetitionsOfAFrequencyInOneTurn) {
  const auto data = transfer_data_so_far(lasting_run(), "dau/acceleration_z");
  EXPECT_TRUE(data.means_are_plain);
  EXPECT_EQ(data.title, "dau/acceleration_z");
  EXPECT_EQ(data.subtitle, "bench acc-1, run r1");
  EXPECT_EQ(data.unit, "1");
  ASSERT_EQ(data.mean.size(), 2U);
  EXPECT_DOUBLE_EQ(data.mean[0].value.magnitude, 1.1);
  EXPECT_NEAR(data.mean[0].value.phase_rad, turn / 2, 1e-12); // not 0, which lies between them
  EXPECT_EQ(data.mean[0].flags, "samples_lost");
  EXPECT_EQ(data.mean[1].value.magnitude, 2.0);
  EXPECT_EQ(data.mean[1].flags, "");
  EXPECT_EQ(data.mean[0].expanded_magnitude, 0.0);
  ASSERT_EQ(data.flag_sentences.size(), 1U);
  EXPECT_EQ(data.flag_sentences[0].find("samples_lost (dau: samples lost)"), 0U);
}

TEST(TransferDataSoFar, GoesOnInTheTurnOfTheFrequencyBefore) {
  RunOutcome outcome = lasting_run();
  outcome.results[0].phase_rad = outcome.results[2].phase_rad = -3.0;
  outcome.results[1].phase_rad = 3.0; // a little later than -3.0: -3.28
  const auto data = transfer_data_so_far(outcome, "dau/acceleration_z");
  EXPECT_NEAR(data.mean[1].value.phase_rad, 3.0 - turn, 1e-12);
}

TEST(TransferDataSoFar, GivesRepetitionsTheirStepResidualAndExpandedUncertainty) {
  const RunOutcome outcome = lasting_run();
  const auto data = transfer_data_so_far(outcome, "dau/acceleration_z");
  ASSERT_EQ(data.repetitions.size(), 3U);
  EXPECT_EQ(data.repetitions[0].residual_rel, 0.01);
  EXPECT_TRUE(std::isnan(data.repetitions[1].residual_rel));
  EXPECT_EQ(data.repetitions[2].step, 3U);
  EXPECT_EQ(data.repetitions[2].repetition, 2U);
  EXPECT_EQ(data.repetitions[1].point.expanded_magnitude,
            magnitude_uncertainty(outcome.results[1]).expanded);
  EXPECT_GT(data.repetitions[1].point.expanded_phase_rad, 2e-3);
}

TEST(TransferDataSoFar, IsEmptyWithoutAValidResult) {
  const auto data = transfer_data_so_far(lasting_run(), "dau/angular_velocity_x");
  EXPECT_TRUE(data.mean.empty());
  EXPECT_TRUE(data.repetitions.empty());
  EXPECT_EQ(data.unit, "");
}

TEST(TransferData, HasTheMeansOfTheFunctionWithUAndItsExpandedValue) {
  const RunOutcome outcome = tests::example_outcome();
  const auto data = transfer_data(outcome, outcome.transfer_functions[0]);
  EXPECT_FALSE(data.means_are_plain);
  ASSERT_EQ(data.mean.size(), 2U);
  EXPECT_EQ(data.mean[0].flags, "samples_lost");
  EXPECT_EQ(data.mean[0].expanded_magnitude,
            magnitude_uncertainty(outcome.transfer_functions[0].points[0].mean).expanded);
  ASSERT_EQ(data.repetitions.size(), 1U); // the other one has no value
  EXPECT_EQ(data.repetitions[0].step, 1U);
  EXPECT_EQ(data.flag_sentences.size(), 2U);
  EXPECT_TRUE(data.group_delay);
}

} // namespace
} // namespace dyncal::inline views
