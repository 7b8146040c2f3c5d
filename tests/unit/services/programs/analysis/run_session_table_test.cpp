// A run whose reference is a system that hands out evaluated steps: it arms with it, waits for its
// steps, and ends without those that never come.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/contract/reference_step.hpp"
#include "tests/unit/services/programs/analysis/played_session.hpp"

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class TableSessionTest : public RunSessionTest {
protected:
  TableSessionTest() { session_ = create(measurement(wire::MEASUREMENT_PLANNED)); }

  wire::Measurement measurement(wire::MeasurementState state) {
    wire::Measurement measurement = synthetic_.measurement();
    measurement.reference_table("acs");
    measurement.state(state);
    return measurement;
  }
  void arm_with_table() {
    arm();
    session_->update(measurement(wire::MEASUREMENT_RUNNING));
  }
  // All of the DAU, and the end of the excitation.
  void excite() {
    dau_.send(synthetic_.dau_blocks());
    announce(wire::EXCITATION_DONE);
    session_->update(measurement(wire::MEASUREMENT_DONE));
    work();
  }
  // Both sources are there, the table is not written.
  void wait(std::chrono::seconds time, wire::MeasurementState state = wire::MEASUREMENT_DONE) {
    for (auto passed = 0ms; passed < time; passed += 500ms) {
      clock_.advance(500ms);
      acs_.send_nothing();
      dau_.send_nothing();
      session_->update(measurement(state));
      work();
    }
  }
  void hand_out(std::uint64_t session) {
    wire::AcsStep step = to_message({.step = 1,
                                     .repetition = 1,
                                     .frequency_text_hz = "40",
                                     .amplitude_m_s2 = 10.0,
                                     .u_amplitude_m_s2 = 1e-3,
                                     .phase_rad = 0.1,
                                     .u_phase_rad = 1e-4});
    step.session(session);
    acs_.hand_out(step);
    work();
  }
  wire::CalibrationResult result() {
    EXPECT_EQ(published_.results().size(), 1U);
    return published_.results().empty() ? wire::CalibrationResult() : published_.results().back();
  }
};

TEST_F(TableSessionTest, ArmsWithTheSourceOfTheTableToo) {
  describe(dau_);
  work();
  dau_.answer(tests::played_run);
  work();
  EXPECT_EQ(arm_state(), wire::ARM_WAITING);
  describe(acs_);
  work();
  acs_.answer(tests::played_run);
  work();
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
}

TEST_F(TableSessionTest, GivesAResultWhenTheStepHasBeenHandedOut) {
  arm_with_table();
  excite();
  EXPECT_TRUE(published_.results().empty());
  hand_out(acs_.description().session());
  wait(1s);
  EXPECT_TRUE(result().valid()) << result().problem();
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
}

TEST_F(TableSessionTest, SaysThatItWaitsForALateStepAndGoesOnWithIt) {
  arm_with_table();
  excite();
  wait(RunSession::silence_limit + 1s);
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  EXPECT_THAT(published_.newest_status().message(),
              HasSubstr("source 'acs' of bench 'synthetic' has handed out 0 of 1 steps"));
  wait(RunSession::patience - 5s);
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
  hand_out(acs_.description().session());
  wait(1s);
  EXPECT_TRUE(result().valid()) << result().problem();
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
}

TEST_F(TableSessionTest, EndsWithoutAStepThatNeverComes) {
  arm_with_table();
  excite();
  wait(RunSession::silence_limit + RunSession::patience + RunSession::quiet_limit + 5s);
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
  EXPECT_FALSE(result().valid());
  EXPECT_THAT(result().problem(), HasSubstr("source 'acs' gave no row of its table"));
}

// Nobody announces steps, as where the system excites them itself.
TEST_F(TableSessionTest, WaitsForAStepThatTheDauHasShown) {
  arm_with_table();
  dau_.send(synthetic_.dau_blocks());
  work();
  wait(RunSession::silence_limit + 1s, wire::MEASUREMENT_RUNNING);
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_WAITING);
  hand_out(acs_.description().session());
  wait(RunSession::announcement_limit + 2s, wire::MEASUREMENT_RUNNING);
  EXPECT_TRUE(result().valid()) << result().problem();
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
}

TEST_F(TableSessionTest, DoesNotWaitForAStepThatIsStillToBeExcited) {
  arm_with_table();
  const auto blocks = synthetic_.dau_blocks();
  dau_.send({blocks.front()});
  wait(RunSession::patience + 20s, wire::MEASUREMENT_RUNNING);
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_OK);
  EXPECT_EQ(arm_state(), wire::ARM_ARMED);
}

TEST_F(TableSessionTest, EndsWithoutAStepThatTheDauHasShownAndThatNeverComes) {
  arm_with_table();
  dau_.send(synthetic_.dau_blocks());
  work();
  wait(RunSession::silence_limit + RunSession::patience + 5s, wire::MEASUREMENT_RUNNING);
  EXPECT_EQ(published_.newest_status().health(), wire::HEALTH_FAILED);
  EXPECT_EQ(arm_state(), wire::ARM_FINISHED);
  EXPECT_THAT(result().problem(), HasSubstr("gave no row of its table"));
}

TEST_F(TableSessionTest, TakesNoStepOfASessionThatTheSourceDoesNotHave) {
  arm_with_table();
  excite();
  hand_out(acs_.description().session() + 7);
  wait(1s);
  EXPECT_TRUE(published_.results().empty());
}

TEST_F(TableSessionTest, TakesNoStepOfAnotherProgram) {
  arm_with_table();
  excite();
  tests::PlayedSource other(network_, acs_.description(), "elsewhere");
  wire::AcsStep step = to_message({.step = 1, .repetition = 1, .amplitude_m_s2 = 99.0});
  step.session(acs_.description().session());
  other.hand_out(step);
  wait(1s);
  EXPECT_TRUE(published_.results().empty());
  EXPECT_THAT(published_.newest_status().message(), HasSubstr("two programs send in the name"));
}

} // namespace
} // namespace dyncal::inline programs
