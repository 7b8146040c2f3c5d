// The conductor of a run at every limit until its last step, against an analysis service and a
// generator that the test plays. No real time passes.
#include "services/run/run_controller.hpp"
#include "services/run/step_sequence.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/run/arming_wait.hpp"
#include "tests/unit/services/run/conducted_run.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;
using run_tests::bench_name;
using run_tests::look;
using run_tests::run_name;

class RunControllerTest : public run_tests::ConductedRun {};

TEST_F(RunControllerTest, ExcitesEveryStepAndCollectsWhatIsPublished) {
  play_analysis();
  clock_.at(8s, [this] {
    analysis_.publish_result(2);
    analysis_.publish_result(1);
    analysis_.publish_transfer_function("dau/acceleration_x");
    finish();
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  EXPECT_FALSE(outcome->interrupted);
  EXPECT_EQ(outcome->analysis_dds, "memory");
  ASSERT_EQ(outcome->results.size(), 2U);
  EXPECT_EQ(outcome->results[0].step, 1U);
  EXPECT_EQ(outcome->transfer_functions.size(), 1U);
  EXPECT_EQ(outcome->planned_steps, 2U);
  EXPECT_EQ(published_state(), wire::MEASUREMENT_DONE);
  EXPECT_EQ(std::count(instrument_.settings.begin(), instrument_.settings.end(), "on"), 2);
}

TEST_F(RunControllerTest, LeavesOutResultsThatItDidNotPlan) {
  play_analysis();
  clock_.at(8s, [&] {
    for (std::uint32_t step = 3; step < 1000; ++step) {
      wire::CalibrationResult result;
      result.channel("dau/acceleration_x");
      result.step(step);
      result.attempt(2); // not counted
      analysis_.publish(result);
    }
    analysis_.publish_result(1);
    analysis_.publish_result(2);
    analysis_.publish_transfer_function("dau/acceleration_x");
    finish();
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  EXPECT_EQ(outcome->results.size(), 2U);
  EXPECT_EQ(outcome->transfer_functions.size(), 1U);
  EXPECT_EQ(std::count_if(notices_.begin(), notices_.end(),
                          [](const std::string& notice) {
                            return notice.starts_with("results of this run came that it did not");
                          }),
            1);
}

TEST_F(RunControllerTest, TakesEveryChannelOfItsSourcesWhereAllAreUnderCalibration) {
  bench_.method.dut.clear();
  play_analysis();
  tests::PlayedAnalysis other(network_, bench_name, run_name);
  clock_.at(8s, [&] {
    other.publish_result(1, "another/acceleration_x");
    analysis_.publish_result(1, "dau/whatever");
    analysis_.publish_transfer_function("dau/whatever");
    finish();
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  ASSERT_EQ(outcome->results.size(), 1U);
  EXPECT_EQ(outcome->results[0].channel, "dau/whatever");
  EXPECT_EQ(outcome->transfer_functions.size(), 1U);
}

// ---- until the run is armed

TEST_F(RunControllerTest, FailsJustAfterItsLimitWhenNobodyAnswers) {
  const auto outcome = conduct();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::no_analysis);
  EXPECT_EQ(outcome.error().message, "no analysis service answers for bench 'b'; is "
                                     "dyncal-analysis running in the same DDS domain?");
  EXPECT_GT(clock_.elapsed(), ArmingWait::answer_limit);
  EXPECT_LE(clock_.elapsed(), ArmingWait::answer_limit + look);
  EXPECT_FALSE(was_excited());
  EXPECT_EQ(published_state(), wire::MEASUREMENT_ABORTED);
}

TEST_F(RunControllerTest, FailsJustAfterItsLimitWhenTheAnalysisDoesNotArm) {
  clock_.every(1s, [this] { analysis_.report(wire::ARM_WAITING); });
  const auto outcome = conduct();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::no_analysis);
  EXPECT_EQ(outcome.error().message,
            "the analysis service analysis@test:1 has not armed for bench 'b'");
  EXPECT_GT(clock_.elapsed(), ArmingWait::limit);
  EXPECT_LE(clock_.elapsed(), ArmingWait::limit + look);
  EXPECT_FALSE(was_excited());
  EXPECT_EQ(published_state(), wire::MEASUREMENT_ABORTED);
}

TEST_F(RunControllerTest, WaitsForAnAnalysisThatFallsSilentBeforeItArms) {
  clock_.at(100ms, [this] { analysis_.report(wire::ARM_WAITING); });
  clock_.every(1s, [this] { // back after a minute
    if (clock_.elapsed() > 67s) {
      analysis_.report(wire::ARM_FINISHED);
    } else if (clock_.elapsed() >= 60s) {
      analysis_.report(wire::ARM_ARMED);
    }
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(was_excited());
}

TEST_F(RunControllerTest, GivesUpAnAnalysisThatStaysSilentBeforeItArms) {
  clock_.at(100ms, [this] { analysis_.report(wire::ARM_WAITING); });
  const auto outcome = conduct();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::no_analysis);
  EXPECT_GT(clock_.elapsed(), StepSequence::away_limit);
  EXPECT_LE(clock_.elapsed(), StepSequence::away_limit + ArmingWait::limit + 4 * look);
  EXPECT_FALSE(was_excited());
}

TEST_F(RunControllerTest, GoesOnWhenTheAnalysisArmsJustBeforeTheLimit) {
  clock_.at(ArmingWait::answer_limit - 1ms, [this] { analysis_.report(wire::ARM_WAITING); });
  clock_.at(ArmingWait::limit - 1ms, [this] { analysis_.report(wire::ARM_ARMED); });
  clock_.every(1s, [this] {
    if (clock_.elapsed() > ArmingWait::limit + 7s) {
      analysis_.report(wire::ARM_FINISHED);
    } else if (clock_.elapsed() > ArmingWait::answer_limit) {
      analysis_.report(clock_.elapsed() < ArmingWait::limit ? wire::ARM_WAITING : wire::ARM_ARMED);
    }
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  EXPECT_TRUE(was_excited());
}

TEST_F(RunControllerTest, PassesOnWhyTheAnalysisRefusesTheRun) {
  clock_.every(1s, [this] {
    if (clock_.elapsed() < 6s) {
      analysis_.report(wire::ARM_WAITING);
    } else {
      analysis_.report(wire::ARM_REFUSED, "source 'dau' of bench 'b' is silent: no packets");
    }
  });
  const auto outcome = conduct();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::no_source);
  EXPECT_EQ(outcome.error().message, "source 'dau' of bench 'b' is silent: no packets");
  EXPECT_EQ(clock_.elapsed(), 6s);
  EXPECT_EQ(instrument_.connections, 0); // it may be that of the run that has the bench
  EXPECT_EQ(published_state(), wire::MEASUREMENT_ABORTED);
}

TEST_F(RunControllerTest, AbortsARunWhoseGeneratorIsNotThere) {
  play_analysis();
  const ConnectGenerator refused = [](const GeneratorSettings&,
                                      const AskOperator&) -> Expected<GeneratorConnection> {
    return fail(ErrorCode::device, "127.0.0.1:9: connection refused");
  };
  RunController controller({participant_, clock_, refused}, bench_, run_name,
                           [](const RunProgress&) {});
  const auto outcome = controller.conduct({}, stop_.get_token());
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::device);
  EXPECT_EQ(outcome.error().message, "127.0.0.1:9: connection refused");
  EXPECT_EQ(published_state(), wire::MEASUREMENT_ABORTED);
}

TEST_F(RunControllerTest, IsInterruptedBeforeTheFirstStepWithoutExcitingAnything) {
  clock_.at(1s, [this] { stop_.request_stop(); });
  const auto outcome = conduct();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::interrupted);
  EXPECT_LE(clock_.elapsed(), 1s + look);
  EXPECT_FALSE(was_excited());
  EXPECT_EQ(published_state(), wire::MEASUREMENT_ABORTED);
}

TEST_F(RunControllerTest, RepeatsItsMeasurementSoThatALostFirstOneDoesNotMatter) {
  network_.lose([](const bus::MessageInTransit& message) {
    return message.topic == bus::topics::measurement && message.number == 0;
  });
  bool heard = false;
  clock_.every(100ms, [&] {
    if (!heard && !analysis_.measurements().empty()) {
      heard = true;
      EXPECT_GE(clock_.elapsed(), 2s);
      EXPECT_LE(clock_.elapsed(), 2s + 2 * look);
      play_analysis();
      clock_.at(12s, [this] { finish(); });
    }
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(heard);
}

TEST_F(RunControllerTest, IsHeldUpByAFullWriterForItsLimitAndThenFails) {
  network_.fill_writers(bus::topics::measurement);
  const auto outcome = conduct();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::no_analysis);
  EXPECT_GE(clock_.elapsed(), 10s); // of one write
  EXPECT_FALSE(was_excited());
}

// ---- while steps are excited

TEST_F(RunControllerTest, EndsJustAfterItsLimitWhenTheAnalysisFallsSilent) {
  clock_.at(100ms, [this] { analysis_.report(wire::ARM_ARMED); });
  bench_.excitation.duration_s = 60.0;
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "the analysis service analysis@test:1 has gone silent");
  const wire::Measurement last = last_published();
  EXPECT_EQ(last.state(), wire::MEASUREMENT_ABORTED);
  EXPECT_EQ(last.message(), outcome->problem);
  EXPECT_GT(clock_.elapsed(), StepSequence::away_limit);
  EXPECT_LE(clock_.elapsed(), StepSequence::away_limit + 100ms + 1s + look);
  EXPECT_EQ(analysis_.excitations().back().state(), wire::EXCITATION_ABORTED);
}

TEST_F(RunControllerTest, GoesOnWhenTheAnalysisReportsJustBeforeTheLimit) {
  bench_.excitation.duration_s = 30.0;
  for (int i = 0; i < 40; ++i) { // taken a look later at most
    clock_.at(100ms + i * (attention_limit - 1s - look),
              [this] { analysis_.report(wire::ARM_ARMED); });
  }
  clock_.at(67s, [this] { finish(); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "");
  EXPECT_TRUE(outcome->pauses.empty());
  EXPECT_EQ(std::count(instrument_.settings.begin(), instrument_.settings.end(), "on"), 2);
}

TEST_F(RunControllerTest, EndsTheStepWhenTheAnalysisReportsALostSource) {
  play_analysis();
  clock_.at(2s, [this] { failure_ = "source 'dau' of bench 'b' has sent nothing for 5 s"; });
  clock_.at(6s, [this] { finish(); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "source 'dau' of bench 'b' has sent nothing for 5 s");
  EXPECT_EQ(published_state(), wire::MEASUREMENT_ABORTED);
  EXPECT_EQ(std::count(instrument_.settings.begin(), instrument_.settings.end(), "on"), 1);
}

TEST_F(RunControllerTest, EndsAtOnceWhenAnAnalysisThatTookOverRefusesTheRun) {
  clock_.every(1s, [this] {
    if (clock_.elapsed() < 3s) {
      analysis_.report(wire::ARM_ARMED);
    } else if (clock_.elapsed() == 3s) { // its last word
      analysis_.report(wire::ARM_REFUSED, "source 'dau' no longer has what it sent");
    }
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "source 'dau' no longer has what it sent");
  EXPECT_EQ(published_state(), wire::MEASUREMENT_ABORTED);
  EXPECT_LE(clock_.elapsed(), 3s + 4 * look);
}

TEST_F(RunControllerTest, SaysThatARunWasRefusedBeforeItsLastResults) {
  play_analysis();
  clock_.at(12s, [this] { // all is excited; the results are missing
    finished_ = true;
    analysis_.report(wire::ARM_REFUSED, "source 'dau' no longer has what it sent");
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "source 'dau' no longer has what it sent");
  EXPECT_LE(clock_.elapsed(), 12s + 2 * look);
}

TEST_F(RunControllerTest, NamesTheStepThatTheGeneratorHasRefused) {
  play_analysis();
  instrument_.failing_call = "set_frequency";
  instrument_.failing_from = 2; // at the second step
  clock_.at(8s, [this] { finish(); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "step 2, 80 Hz: set_frequency was refused (attempts: 1)");
  EXPECT_EQ(published_state(), wire::MEASUREMENT_ABORTED);
}

TEST_F(RunControllerTest, HoldsWhatWasMeasuredWhenItIsInterrupted) {
  play_analysis();
  clock_.at(2s, [this] { stop_.request_stop(); });
  clock_.at(3s, [this] {
    analysis_.publish_result(1);
    finish();
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_TRUE(outcome->interrupted);
  EXPECT_EQ(outcome->problem, "");
  const wire::Measurement last = last_published();
  EXPECT_EQ(last.state(), wire::MEASUREMENT_ABORTED);
  EXPECT_EQ(last.message(), "interrupted by the user");
  EXPECT_EQ(outcome->results.size(), 1U);
}

TEST_F(RunControllerTest, KeepsTheRunAliveWhileStepsAreExcited) {
  bench_.excitation.duration_s = 20.0;
  play_analysis();
  std::size_t messages = 0;
  auto longest = 0ns;
  auto last = 0ns;
  clock_.every(50ms, [&] {
    if (const auto came = analysis_.measurements().size(); came > 0) {
      messages += came;
      longest = std::max(longest, clock_.elapsed() - last);
      last = clock_.elapsed();
    }
  });
  clock_.at(45s, [this] { finish(); });
  ASSERT_TRUE(conduct());
  EXPECT_GT(messages, 12U);
  EXPECT_LE(longest, 3s + look); // an analysis gives the run up after 15 s
}

} // namespace
} // namespace dyncal::inline run
