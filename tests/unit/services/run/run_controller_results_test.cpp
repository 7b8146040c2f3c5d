// What a conductor waits for behind its last step, and what it takes for results of its run. No
// real time passes.
#include "services/run/run_controller.hpp"
#include "services/run/step_sequence.hpp"

#include <set>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/run/conducted_run.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;
using run_tests::bench_name;
using run_tests::look;
using run_tests::run_name;

class RunControllerResultsTest : public run_tests::ConductedRun {};

// ---- until the last result

TEST_F(RunControllerResultsTest, WaitsForResultsThatFinishedOvertakes) {
  play_analysis();
  clock_.at(8s, [this] {
    analysis_.publish_transfer_function("dau/acceleration_x");
    analysis_.count_transfer_function();
    finish();
  });
  clock_.at(9s, [this] { analysis_.publish_transfer_function("dau/acceleration_y"); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  ASSERT_EQ(outcome->transfer_functions.size(), 2U);
  EXPECT_EQ(outcome->transfer_functions[1].channel, "dau/acceleration_y");
  EXPECT_EQ(clock_.elapsed(), 9s);
}

TEST_F(RunControllerResultsTest, WaitsUntilNoResultIsProvisionalAnyMore) {
  play_analysis();
  clock_.at(7s, [this] { analysis_.publish_provisional_result(1, false); });
  clock_.at(8s, [this] { finish(); });
  clock_.at(9s, [this] { analysis_.publish_provisional_result(1, true); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  ASSERT_EQ(outcome->results.size(), 1U);
  EXPECT_FALSE(outcome->results[0].provisional);
  EXPECT_EQ(clock_.elapsed(), 9s);
}

TEST_F(RunControllerResultsTest, GivesUpJustAfterItsLimitWhenTheLastResultsDoNotCome) {
  play_analysis();
  std::chrono::nanoseconds excitation_done{};
  clock_.every(50ms, [&] {
    for (const wire::Measurement& measurement : analysis_.measurements()) {
      if (measurement.state() == wire::MEASUREMENT_DONE && excitation_done == 0ns) {
        excitation_done = clock_.elapsed();
      }
    }
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "the last results have not come from the analysis service");
  EXPECT_EQ(published_state(), wire::MEASUREMENT_DONE); // it was excited as planned
  EXPECT_GE(clock_.elapsed() - excitation_done, StepSequence::results_limit - 50ms);
  EXPECT_LE(clock_.elapsed() - excitation_done, StepSequence::results_limit + look);
}

TEST_F(RunControllerResultsTest, TellsWithWhichSoftwareItWasArmed) {
  play_analysis();
  std::set<std::string> before;
  std::set<std::string> after;
  clock_.every(50ms, [&] {
    for (const wire::Measurement& measurement : analysis_.measurements()) {
      (measurement.state() == wire::MEASUREMENT_PLANNED ? before : after)
          .insert(measurement.analysis_software());
    }
  });
  clock_.at(7s, [this] { finish(); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_THAT(before, testing::ElementsAre(""));
  EXPECT_THAT(after, testing::ElementsAre("dyncal of the test"));
}

// As where a changed packet takes the number of the message that was to come: DDS has delivered it.
class MissedMessage : public RunControllerResultsTest,
                      public testing::WithParamInterface<const char*> {};

INSTANTIATE_TEST_SUITE_P(OfTheAnalysis, MissedMessage,
                         testing::Values(bus::topics::calibration_result.name,
                                         bus::topics::transfer_function.name,
                                         bus::topics::service_status.name),
                         [](const auto& topic) { return std::string(topic.param); });

TEST_P(MissedMessage, IsCollectedOnceMore) {
  play_analysis();
  bool missed = false;
  network_.lose([&](const bus::MessageInTransit& message) {
    return clock_.elapsed() >= 7s && message.topic == GetParam() && message.receiver == "runner" &&
           !std::exchange(missed, true);
  });
  clock_.at(7s, [this] {
    finished_ = true;
    analysis_.publish_result(1);
    analysis_.publish_result(2);
    analysis_.publish_transfer_function("dau/acceleration_x");
    finish();
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(missed);
  EXPECT_EQ(outcome->problem, "");
  EXPECT_EQ(outcome->results.size(), 2U);
  EXPECT_EQ(outcome->transfer_functions.size(), 1U);
  EXPECT_GE(clock_.elapsed(), 7s + StepSequence::missed_limit - 50ms);
  EXPECT_LE(clock_.elapsed(), 7s + StepSequence::missed_limit + attention_limit + 2 * look);
}

TEST_F(RunControllerResultsTest, WaitsAnewAfterEveryResult) {
  play_analysis();
  const std::vector<std::pair<std::uint32_t, std::string>> results{
      {1, "dau/acceleration_x"}, {1, "dau/acceleration_y"}, {2, "dau/acceleration_x"}};
  for (std::size_t i = 0; i < results.size(); ++i) {
    clock_.at(6s + (i + 1) * (StepSequence::results_limit - look), [this, result = results[i]] {
      analysis_.publish_result(result.first, result.second);
    });
  }
  clock_.at(6s + 3 * StepSequence::results_limit, [this] { finish(); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "");
  EXPECT_EQ(outcome->results.size(), 3U);
}

TEST_F(RunControllerResultsTest, WaitsAsLongAsTheAnalysisIsAtWork) {
  play_analysis();
  for (int i = 1; i <= 5 * StepSequence::results_limit.count(); ++i) {
    clock_.at(6s + std::chrono::seconds(i), [this, i] {
      analysis_.report(wire::ARM_ARMED, wire::HEALTH_OK,
                       "evaluating a step, for " + std::to_string(i) + " s so far");
    });
  }
  clock_.at(6s + 5 * StepSequence::results_limit + 1s, [this] {
    analysis_.publish_result(1);
    finish();
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "");
  EXPECT_EQ(outcome->results.size(), 1U);
}

TEST_F(RunControllerResultsTest, EndsWhenTheAnalysisDiesBeforeTheLastResult) {
  play_analysis();
  clock_.at(7s, [this] { finished_ = true; }); // and says nothing any more
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "the analysis service analysis@test:1 has gone silent");
  EXPECT_LE(clock_.elapsed(), 7s + StepSequence::away_limit + look);
}

// As it is: messages of another run on the bench are left out, and nothing else keeps two runs
// apart.
TEST_F(RunControllerResultsTest, LeavesOutMessagesOfAnotherRunOnTheBench) {
  tests::PlayedAnalysis other(network_, bench_name, "r2");
  other.report(wire::ARM_REFUSED, "not this one");
  other.publish_result(1);
  play_analysis();
  clock_.at(8s, [this] { finish(); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(outcome->results.empty());
}

// A program that calls itself as the analysis of the run.
TEST_F(RunControllerResultsTest, LeavesOutWhatAnotherProgramPublishesAboutTheRun) {
  tests::PlayedAnalysis other(network_, bench_name, run_name);
  play_analysis();
  for (const auto at : {1300ms, 2300ms, 4300ms}) { // not beside what it would replace in a reader
    clock_.at(at, [&] {
      other.report(wire::ARM_ARMED, "it says");
      other.publish_result(1);
      other.publish_result(2);
      other.publish_transfer_function("dau/acceleration_x");
    });
  }
  clock_.at(7s, [this] { analysis_.publish_result(1); });
  clock_.at(8s, [this] { finish(); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  EXPECT_EQ(outcome->results.size(), 1U);
  EXPECT_TRUE(outcome->transfer_functions.empty());
  EXPECT_THAT(notices_, testing::Contains(testing::HasSubstr("publishes about this run and is "
                                                             "not its analysis"))
                            .Times(1));
}

// All of them come once more from the one that takes the run over, some before it is heard.
TEST_F(RunControllerResultsTest, TakesTheResultsOfTheAnalysisThatTakesTheRunOver) {
  tests::PlayedAnalysis next(network_, bench_name, run_name, "analysis@other:1");
  play_analysis();
  clock_.at(2s, [this] {
    analysis_.publish_result(1);
    finished_ = true; // and says nothing any more
  });
  clock_.at(4s, [&] { next.publish_result(1, "dau/acceleration_y"); });
  clock_.every(1s, [&] {
    if (clock_.elapsed() > 5s) {
      next.report(clock_.elapsed() < 30s ? wire::ARM_ARMED : wire::ARM_FINISHED);
    }
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->results.size(), 2U);
  EXPECT_EQ(outcome->analysis_software, "dyncal of the test");
}

// An analysis keeps the results of past runs: on a slow link they would come before all else.
TEST_F(RunControllerResultsTest, IsSentNoResultsOfRunsBefore) {
  tests::PlayedAnalysis before(network_, bench_name, "r0");
  before.publish_result(1);
  before.publish_transfer_function("dau/acceleration_x");
  std::set<std::string> of_runs;
  network_.lose([&](const bus::MessageInTransit& message) {
    if (message.receiver == "runner" && message.topic == bus::topics::calibration_result.name) {
      of_runs.insert(message.as<wire::CalibrationResult>().run().to_string());
    }
    return false;
  });
  play_analysis();
  clock_.at(8s, [this] {
    analysis_.publish_result(1);
    finish();
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_THAT(of_runs, testing::ElementsAre(run_name));
}

TEST_F(RunControllerResultsTest, CollectsWhatAnAnalysisOfContract1WritesForTheBenchAlone) {
  tests::PlayedAnalysis older(network_, bench_name, run_name, "analysis@test:0", 1);
  clock_.every(1s,
               [&] { older.report(clock_.elapsed() < 8s ? wire::ARM_ARMED : wire::ARM_FINISHED); });
  clock_.at(7s, [&] {
    older.publish_result(1);
    older.publish_result(2);
    older.publish_transfer_function("dau/acceleration_x");
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  EXPECT_EQ(outcome->results.size(), 2U);
  EXPECT_EQ(outcome->transfer_functions.size(), 1U);
}

// ---- recorded files in place of an excitation

class RunOfFiles : public RunControllerResultsTest {
protected:
  RunOfFiles() { bench_.generator.driver = GeneratorDriver::none; }
};

TEST_F(RunOfFiles, WaitsAsLongAsTheAnalysisIsWell) {
  play_analysis();
  clock_.at(4 * StepSequence::results_limit, [this] {
    EXPECT_EQ(published_state(), wire::MEASUREMENT_RUNNING);
    finish();
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "");
  EXPECT_FALSE(instrument_.connected);
  EXPECT_EQ(published_state(), wire::MEASUREMENT_DONE);
}

TEST_F(RunOfFiles, AbortsWhenTheAnalysisReportsALostSource) {
  play_analysis();
  clock_.at(5s, [this] { failure_ = "source 'dau' of bench 'b' has sent nothing for 5 s"; });
  clock_.at(9s, [this] {
    EXPECT_EQ(published_state(), wire::MEASUREMENT_ABORTED);
    finish();
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "source 'dau' of bench 'b' has sent nothing for 5 s");
}

TEST_F(RunOfFiles, IsAbortedByTheUser) {
  play_analysis();
  clock_.at(5s, [this] { stop_.request_stop(); });
  clock_.at(6s, [this] { finish(); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_TRUE(outcome->interrupted);
  EXPECT_EQ(published_state(), wire::MEASUREMENT_ABORTED);
}

} // namespace
} // namespace dyncal::inline run
