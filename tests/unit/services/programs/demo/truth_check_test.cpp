#include "services/programs/demo/truth_check.hpp"

#include <fstream>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline programs {
namespace {

class TruthCheck : public testing::Test {
protected:
  std::filesystem::path truth_file(const std::string& text) {
    return folder_.write("truth.json", text);
  }

private:
  const tests::TemporaryFolder folder_;
};

const char* const one_point =
    R"({"transfer_function": [{"channel": "acceleration_z", "frequency_text_hz": "40", "frequency_hz": 40, "magnitude": 1.0, "phase_rad": 3.1}]})";

RunOutcome outcome(double magnitude, double phase_rad) {
  FrequencyPoint point;
  point.frequency_text_hz = "40";
  point.mean.magnitude = magnitude;
  point.mean.u_magnitude = 0.01;
  point.mean.phase_rad = phase_rad;
  point.mean.u_phase_rad = 0.01;
  TransferFunction function;
  function.channel = "dau/acceleration_z";
  function.points.push_back(point);
  RunOutcome run;
  run.transfer_functions.push_back(function);
  return run;
}

TEST_F(TruthCheck, ComparesMagnitudeAndPhaseInStandardUncertainties) {
  const auto check = check_truth(outcome(1.03, 3.11), truth_file(one_point));
  ASSERT_TRUE(check) << check.error().message;
  EXPECT_EQ(check->points, 2U);
  EXPECT_NEAR(check->worst, 3.0, 1e-9);
  EXPECT_EQ(check->worst_where, "dau/acceleration_z, 40 Hz, magnitude");
}

TEST_F(TruthCheck, TakesWholeTurnsOutOfThePhase) {
  const auto check =
      check_truth(outcome(1.0, 3.12 - 2.0 * std::numbers::pi), truth_file(one_point));
  EXPECT_NEAR(check->worst, 2.0, 1e-9);
}

TEST_F(TruthCheck, AnExcitedChannelWithoutAResultIsAnError) {
  RunOutcome none;
  EXPECT_THAT(check_truth(none, truth_file(one_point)).error().message,
              testing::HasSubstr("no result for acceleration_z at 40 Hz"));
}

TEST_F(TruthCheck, AFileThatIsNoTruthIsAnError) {
  EXPECT_FALSE(check_truth(outcome(1.0, 0.0), truth_file("{")));
}

} // namespace
} // namespace dyncal::inline programs
