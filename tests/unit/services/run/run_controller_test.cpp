// The conductor of a run at every limit, against an analysis service and a generator that the test
// plays. No real time passes.
#include "services/run/run_controller.hpp"

#include <set>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/run/played_analysis.hpp"
#include "tests/unit/services/run/played_generator.hpp"
#include "tests/unit/services/run/two_steps.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;

constexpr const char* bench_name = "b";
constexpr const char* run_name = "r1";
constexpr auto look = 200ms; // between two looks at the messages

class RunControllerTest : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  tests::PlayedAnalysis analysis_{network_, bench_name, run_name};
  bus::Participant participant_ = network_.join("runner");
  tests::PlayedInstrument instrument_{clock_};
  BenchFile bench_ = bench();
  std::stop_source stop_;
  std::vector<std::string> phases_;
  std::vector<std::string> notices_;

  static BenchFile bench() {
    BenchFile bench = tests::bench_of_two_steps(bench_name);
    bench.method.dut = {{"dau", "acceleration_x"}, {"dau", "acceleration_y"}};
    return bench;
  }

  Expected<RunOutcome> conduct() {
    RunController controller({participant_, clock_, tests::connect_to(instrument_)}, bench_,
                             run_name, [this](const RunProgress& progress) {
                               phases_.push_back(progress.phase);
                               if (!progress.notice.empty()) {
                                 notices_.push_back(progress.notice);
                               }
                             });
    auto outcome = controller.conduct({}, stop_.get_token());
    EXPECT_FALSE(instrument_.on);
    return outcome;
  }
  [[nodiscard]] bool was_excited() const {
    return std::find(instrument_.settings.begin(), instrument_.settings.end(), "on") !=
           instrument_.settings.end();
  }
  [[nodiscard]] wire::Measurement last_published() {
    const auto measurements = analysis_.measurements();
    return measurements.empty() ? wire::Measurement{} : measurements.back();
  }
  [[nodiscard]] wire::MeasurementState published_state() { return last_published().state(); }
  // Arms at once and reports every second from then on, until `finish` is called.
  void play_analysis() {
    clock_.at(100ms, [this] { analysis_.report(wire::ARM_ARMED); });
    clock_.every(1s, [this] {
      if (!finished_) {
        analysis_.report(wire::ARM_ARMED, failure_);
      }
    });
  }
  void finish() {
    finished_ = true;
    analysis_.report(wire::ARM_FINISHED, failure_);
  }
  bool finished_ = false;
  std::string failure_;
};

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
  tests::PlayedAnalysis other(network_, bench_name, run_name);
  clock_.at(8s, [&] {
    for (std::uint32_t step = 3; step < 1000; ++step) {
      other.publish_result(step);
    }
    other.publish_result(1, "dau/another");
    other.publish_transfer_function("dau/another");
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
  EXPECT_GT(clock_.elapsed(), RunController::answer_limit);
  EXPECT_LE(clock_.elapsed(), RunController::answer_limit + look);
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
  EXPECT_GT(clock_.elapsed(), RunController::armed_limit);
  EXPECT_LE(clock_.elapsed(), RunController::armed_limit + look);
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
  EXPECT_GT(clock_.elapsed(), RunController::analysis_limit);
  EXPECT_LE(clock_.elapsed(),
            RunController::analysis_limit + RunController::armed_limit + 4 * look);
  EXPECT_FALSE(was_excited());
}

TEST_F(RunControllerTest, GoesOnWhenTheAnalysisArmsJustBeforeTheLimit) {
  clock_.at(RunController::answer_limit - 1ms, [this] { analysis_.report(wire::ARM_WAITING); });
  clock_.at(RunController::armed_limit - 1ms, [this] { analysis_.report(wire::ARM_ARMED); });
  clock_.every(1s, [this] {
    if (clock_.elapsed() > RunController::armed_limit + 7s) {
      analysis_.report(wire::ARM_FINISHED);
    } else if (clock_.elapsed() > RunController::answer_limit) {
      analysis_.report(clock_.elapsed() < RunController::armed_limit ? wire::ARM_WAITING
                                                                     : wire::ARM_ARMED);
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
  EXPECT_GT(clock_.elapsed(), RunController::analysis_limit);
  EXPECT_LE(clock_.elapsed(), RunController::analysis_limit + 100ms + 1s + look);
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

// ---- until the last result

TEST_F(RunControllerTest, WaitsForResultsThatFinishedOvertakes) {
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

TEST_F(RunControllerTest, WaitsUntilNoResultIsProvisionalAnyMore) {
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

TEST_F(RunControllerTest, GivesUpJustAfterItsLimitWhenTheLastResultsDoNotCome) {
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
  EXPECT_GE(clock_.elapsed() - excitation_done, RunController::results_limit - 50ms);
  EXPECT_LE(clock_.elapsed() - excitation_done, RunController::results_limit + look);
}

TEST_F(RunControllerTest, TellsWithWhichSoftwareItWasArmed) {
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
class MissedMessage : public RunControllerTest, public testing::WithParamInterface<const char*> {};

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
  EXPECT_GE(clock_.elapsed(), 7s + RunController::missed_limit - 50ms);
  EXPECT_LE(clock_.elapsed(), 7s + RunController::missed_limit + attention_limit + 2 * look);
}

TEST_F(RunControllerTest, WaitsAnewAfterEveryResult) {
  play_analysis();
  const std::vector<std::pair<std::uint32_t, std::string>> results{
      {1, "dau/acceleration_x"}, {1, "dau/acceleration_y"}, {2, "dau/acceleration_x"}};
  for (std::size_t i = 0; i < results.size(); ++i) {
    clock_.at(6s + (i + 1) * (RunController::results_limit - look), [this, result = results[i]] {
      analysis_.publish_result(result.first, result.second);
    });
  }
  clock_.at(6s + 3 * RunController::results_limit, [this] { finish(); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "");
  EXPECT_EQ(outcome->results.size(), 3U);
}

TEST_F(RunControllerTest, WaitsAsLongAsTheAnalysisIsAtWork) {
  play_analysis();
  for (int i = 1; i <= 5 * RunController::results_limit.count(); ++i) {
    clock_.at(6s + std::chrono::seconds(i), [this, i] {
      analysis_.report(wire::ARM_ARMED, wire::HEALTH_OK,
                       "evaluating a step, for " + std::to_string(i) + " s so far");
    });
  }
  clock_.at(6s + 5 * RunController::results_limit + 1s, [this] {
    analysis_.publish_result(1);
    finish();
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "");
  EXPECT_EQ(outcome->results.size(), 1U);
}

TEST_F(RunControllerTest, EndsWhenTheAnalysisDiesBeforeTheLastResult) {
  play_analysis();
  clock_.at(7s, [this] { finished_ = true; }); // and says nothing any more
  const auto outcome = conduct();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->problem, "the analysis service analysis@test:1 has gone silent");
  EXPECT_LE(clock_.elapsed(), 7s + RunController::analysis_limit + look);
}

// As it is: messages of another run on the bench are left out, and nothing else keeps two runs
// apart.
TEST_F(RunControllerTest, LeavesOutMessagesOfAnotherRunOnTheBench) {
  tests::PlayedAnalysis other(network_, bench_name, "r2");
  other.report(wire::ARM_REFUSED, "not this one");
  other.publish_result(1);
  play_analysis();
  clock_.at(8s, [this] { finish(); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(outcome->results.empty());
}

// An analysis keeps the results of past runs: on a slow link they would come before all else.
TEST_F(RunControllerTest, IsSentNoResultsOfRunsBefore) {
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

TEST_F(RunControllerTest, CollectsWhatAnAnalysisOfContract1WritesForTheBenchAlone) {
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

class RunOfFiles : public RunControllerTest {
protected:
  RunOfFiles() { bench_.generator.driver = GeneratorDriver::none; }
};

TEST_F(RunOfFiles, WaitsAsLongAsTheAnalysisIsWell) {
  play_analysis();
  clock_.at(4 * RunController::results_limit, [this] {
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
} // namespace dyncal::services
