// What disturbs a run while it is excited, at every limit: the output is off meanwhile, the run
// goes on when it can, and what was spoilt is repeated. No real time passes.
#include "services/run/step_sequence.hpp"

#include <functional>
#include <map>
#include <utility>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/run/run_controller.hpp"
#include "tests/unit/services/run/played_analysis.hpp"
#include "tests/unit/services/run/played_generator.hpp"
#include "tests/unit/services/run/two_steps.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr const char* bench_name = "b";
constexpr const char* run_name = "r1";

using Attempt = std::pair<std::uint32_t, std::uint32_t>; // step, attempt

class StepSequenceTest : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  tests::PlayedAnalysis analysis_{network_, bench_name, run_name};
  tests::PlayedAnalysis standby_{network_, bench_name, run_name, "analysis@test:2"};
  bus::Participant participant_ = network_.join("runner");
  bus::Participant operator_ = network_.join("operator");
  bus::Writer<wire::Command> commands_ = operator_.writer(bus::topics::command, bench_name).value();
  tests::PlayedInstrument instrument_{clock_};
  BenchFile bench_ = bench();
  std::stop_source stop_;

  // The analysis: reports twice a second unless it is silent, and publishes what `evaluate` makes
  // of a step as soon as its excitation is over.
  bool silent_ = false;
  bool standby_serves_ = false;
  bool finished_ = false;
  wire::HealthState health_ = wire::HEALTH_OK;
  std::string message_;
  std::function<wire::CalibrationResult(Attempt)> evaluate_ = [](Attempt attempt) {
    return good(attempt);
  };
  std::map<std::uint32_t, wire::CalibrationResult> published_; // by step
  std::chrono::nanoseconds reported_{};
  // What was seen on the way.
  std::vector<Attempt> excited_; // every attempt that was announced to be on
  std::vector<Attempt> aborted_;
  std::vector<std::uint32_t> repeated_steps_; // as announced last
  wire::MeasurementState state_ = wire::MEASUREMENT_PLANNED;
  std::vector<std::string> messages_; // of the Measurement
  std::vector<std::string> notices_;
  std::chrono::nanoseconds longest_unattended_{}; // output on, and nothing heard for so long
  bool began_unattended_ = false;
  bool was_on_ = false;

  static BenchFile bench() {
    BenchFile bench = tests::bench_of_two_steps(bench_name);
    bench.excitation.frequencies_hz.push_back("125");
    bench.excitation.levels_m_s2.push_back(10.0);
    return bench;
  }
  static wire::CalibrationResult good(Attempt attempt) {
    wire::CalibrationResult result;
    result.channel("dau/acceleration_x");
    result.step(attempt.first);
    result.attempt(attempt.second);
    result.valid(true);
    return result;
  }
  static wire::CalibrationResult lossy(Attempt attempt) {
    wire::CalibrationResult result = good(attempt);
    result.lost(50);
    return result;
  }

  void SetUp() override {
    clock_.every(100ms, [this] { follow_run(); });
    clock_.every(500ms, [this] { report(); });
    clock_.every(10ms, [this] { watch_output(); });
  }
  void report() {
    if (finished_) {
      return;
    }
    if (!silent_) {
      reported_ = clock_.elapsed();
      analysis_.report(wire::ARM_ARMED, health_, message_);
    } else if (standby_serves_) {
      reported_ = clock_.elapsed();
      standby_.report(wire::ARM_ARMED, health_, message_);
    }
  }
  void follow_run() {
    for (const wire::Measurement& measurement : analysis_.measurements()) {
      state_ = measurement.state();
      if (!measurement.message().empty() &&
          (messages_.empty() || messages_.back() != measurement.message())) {
        messages_.push_back(measurement.message());
      }
    }
    for (const wire::Excitation& excitation : analysis_.excitations()) {
      follow(excitation);
    }
    const bool over = state_ == wire::MEASUREMENT_DONE || state_ == wire::MEASUREMENT_ABORTED;
    if (over && !finished_ && !silent_) {
      finished_ = true;
      analysis_.report(wire::ARM_FINISHED);
    }
  }
  void follow(const wire::Excitation& excitation) {
    const Attempt attempt{excitation.step(), excitation.attempt()};
    repeated_steps_ = excitation.repeated_steps();
    const bool over = excitation.state() == wire::EXCITATION_DONE ||
                      excitation.state() == wire::EXCITATION_ABORTED;
    if (excited_.empty() || excited_.back() != attempt) {
      excited_.push_back(attempt);
    }
    if (excitation.state() == wire::EXCITATION_ABORTED) {
      aborted_.push_back(attempt);
    }
    const auto known = published_.find(attempt.first);
    if (over && (known == published_.end() || known->second.attempt() < attempt.second)) {
      published_[attempt.first] = evaluate_(attempt);
      if (published_[attempt.first].step() != 0) {
        analysis_.publish(published_[attempt.first]);
      }
    }
  }
  void watch_output() {
    if (instrument_.on) {
      longest_unattended_ = std::max(longest_unattended_, clock_.elapsed() - reported_);
      began_unattended_ =
          began_unattended_ || (!was_on_ && clock_.elapsed() - reported_ > attention_limit);
    }
    was_on_ = instrument_.on;
  }
  void command(wire::CommandKind kind, std::uint32_t step = 0) {
    wire::Command command;
    command.bench(bench_name);
    command.target("conductor");
    command.kind(kind);
    command.run(run_name);
    command.sender("ada@desk");
    command.step(step);
    commands_.write(command);
  }
  void silent_between(std::chrono::nanoseconds begin, std::chrono::nanoseconds end) {
    clock_.at(begin, [this] { silent_ = true; });
    clock_.at(end, [this] { silent_ = false; });
  }
  void away_between(std::chrono::nanoseconds begin, std::chrono::nanoseconds end) {
    clock_.at(begin, [this] { instrument_.away = true; });
    clock_.at(end, [this] { instrument_.away = false; });
  }
  Expected<RunOutcome> try_to_resume() { return controller().resume({}, stop_.get_token()); }
  RunController controller() {
    return {{participant_, clock_, tests::connect_to(instrument_)},
            bench_,
            run_name,
            [this](const RunProgress& progress) {
              if (!progress.notice.empty()) {
                notices_.push_back(progress.notice);
              }
            }};
  }
  RunOutcome conduct() {
    auto outcome = controller().conduct({}, stop_.get_token());
    EXPECT_TRUE(outcome) << outcome.error().message;
    return outcome.value_or(RunOutcome{});
  }
  [[nodiscard]] static std::vector<std::uint32_t> attempts_of(const RunOutcome& outcome) {
    std::vector<std::uint32_t> attempts;
    for (const StepResult& result : outcome.results) {
      attempts.push_back(result.attempt);
    }
    return attempts;
  }
};

TEST_F(StepSequenceTest, AnUndisturbedRunHasNeitherPausesNorRepeats) {
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(outcome.pauses, IsEmpty());
  EXPECT_THAT(notices_, IsEmpty());
  EXPECT_THAT(messages_, IsEmpty());
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 1, 1));
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}));
  EXPECT_LT(clock_.elapsed(), 12s); // does not wait for anything
}

// ---- the analysis is away

TEST_F(StepSequenceTest, AStepIsBrokenOffWhileTheAnalysisIsSilentAndRepeatedAtTheEnd) {
  bench_.excitation.duration_s = 10.0;
  silent_between(14s, 60s); // in the second step
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{2, 2}));
  EXPECT_THAT(aborted_, ElementsAre(Attempt{2, 1}));
  EXPECT_THAT(repeated_steps_, ElementsAre(2));
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  EXPECT_LE(longest_unattended_, attention_limit + 1s + 200ms);
  EXPECT_FALSE(began_unattended_);
  ASSERT_EQ(outcome.pauses.size(), 1U);
  const RunPause& pause = outcome.pauses[0];
  EXPECT_EQ(pause.reason, "the analysis service analysis@test:1 has gone silent; waiting for it or "
                          "another up to 120 s (the output is off)");
  EXPECT_NEAR(static_cast<double>(pause.ended_utc_ns - pause.began_utc_ns) * 1e-9, 42.5, 1.5);
  EXPECT_THAT(messages_, Contains("the analysis service analysis@test:1 has gone silent; waiting "
                                  "for it or another up to 120 s (the output is off)"));
  EXPECT_THAT(notices_, Contains(HasSubstr("waiting for it or another up to 120 s")));
  EXPECT_THAT(notices_, Contains("step 2 is excited again, attempt 2: its excitation was broken "
                                 "off"));
}

// Else a step of the same frequency could be taken for it.
TEST_F(StepSequenceTest, TheNextStepWaitsForTheResultOfTheOneThatWasBrokenOff) {
  bench_.excitation.duration_s = 10.0;
  silent_between(14s, 20s);
  evaluate_ = [this](Attempt attempt) {
    if (attempt != Attempt{2, 1}) {
      return good(attempt);
    }
    clock_.at(25s, [this] {
      EXPECT_EQ(excited_.size(), 2U);
      analysis_.publish(lossy({2, 1}));
    });
    return wire::CalibrationResult{};
  };
  const RunOutcome outcome = conduct();
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
}

TEST_F(StepSequenceTest, TheResultOfAStepThatWasBrokenOffIsNotWaitedForForever) {
  bench_.excitation.duration_s = 10.0;
  silent_between(14s, 20s);
  evaluate_ = [](Attempt attempt) {
    return attempt == Attempt{2, 1} ? wire::CalibrationResult{} : good(attempt);
  };
  clock_.at(34s, [this] { EXPECT_EQ(excited_.size(), 3U); });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(excited_.size(), 3U); // no repeats: not all results have come
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
}

TEST_F(StepSequenceTest, AnAnalysisThatIsSilentForJustLessThanTheLimitIsWaitedFor) {
  bench_.excitation.duration_s = 10.0;
  silent_between(5s, 4500ms + StepSequence::away_limit - 600ms);
  EXPECT_EQ(conduct().problem, "");
}

TEST_F(StepSequenceTest, AnAnalysisThatDoesNotComeBackEndsTheRun) {
  bench_.excitation.duration_s = 10.0;
  silent_between(5s, 1000s);
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "the analysis service analysis@test:1 has gone silent");
  EXPECT_GT(clock_.elapsed(), 4500ms + StepSequence::away_limit);
  EXPECT_EQ(state_, wire::MEASUREMENT_ABORTED);
  EXPECT_NE(outcome.pauses.at(0).ended_utc_ns, 0);
}

TEST_F(StepSequenceTest, AnotherAnalysisTakesTheRunOver) {
  bench_.excitation.duration_s = 10.0;
  silent_between(14s, 1000s);
  clock_.at(30s, [this] { standby_.report(wire::ARM_WAITING); });
  clock_.at(31s, [this] {
    EXPECT_FALSE(instrument_.on); // it is not armed yet
    standby_.publish(good({1, 1}));
    standby_serves_ = true;
  });
  clock_.at(70s, [this] {
    EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
    standby_serves_ = false;
    standby_.report(wire::ARM_FINISHED);
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
}

TEST_F(StepSequenceTest, AStandbyThatReportsBesideTheAnalysisChangesNothing) {
  clock_.every(300ms, [this] { standby_.report(wire::ARM_WAITING, "standing by"); });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(outcome.pauses, IsEmpty());
}

// An analysis that was restarted publishes everything again.
TEST_F(StepSequenceTest, AResultOfAnEarlierAttemptTakesNoLaterOnesPlace) {
  evaluate_ = [this](Attempt attempt) {
    if (attempt == Attempt{1, 2}) {
      // taken after the other
      clock_.at(clock_.elapsed() + 250ms, [this] { analysis_.publish(lossy({1, 1})); });
    }
    return attempt == Attempt{1, 1} ? lossy(attempt) : good(attempt);
  };
  const RunOutcome outcome = conduct();
  EXPECT_THAT(attempts_of(outcome), ElementsAre(2, 1, 1));
  EXPECT_EQ(outcome.results[0].lost, 0U);
}

TEST_F(StepSequenceTest, NoStepIsBegunUnlessTheAnalysisWasHeardLately) {
  for (int i = 0; i < 12; ++i) { // silent again and again, in steps and between them
    silent_between(3s + i * 9s, 3s + i * 9s + 5100ms);
  }
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_FALSE(began_unattended_);
  EXPECT_LE(longest_unattended_, attention_limit + 1s + 200ms);
  EXPECT_GE(outcome.pauses.size(), 2U);
}

TEST_F(StepSequenceTest, TheRunEndsWhenTheAnalysisHasEndedIt) {
  bench_.excitation.duration_s = 10.0;
  clock_.at(5s, [this] {
    finished_ = true;
    analysis_.report(wire::ARM_FINISHED);
  });
  EXPECT_THAT(conduct().problem, HasSubstr("has ended the run before its last step"));
  EXPECT_LT(clock_.elapsed(), 8s);
}

// ---- a source is away

TEST_F(StepSequenceTest, ASourceThatTheAnalysisWaitsForPausesTheRun) {
  bench_.excitation.duration_s = 10.0;
  clock_.at(14s, [this] {
    health_ = wire::HEALTH_WAITING;
    message_ = "source 'dau' of bench 'b' has sent nothing for 5 s";
  });
  clock_.at(16s, [this] { EXPECT_FALSE(instrument_.on); });
  clock_.at(100s, [this] {
    health_ = wire::HEALTH_OK;
    message_.clear();
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  EXPECT_THAT(outcome.pauses.at(0).reason,
              StartsWith("source 'dau' of bench 'b' has sent nothing for 5 s; waiting"));
  EXPECT_THAT(notices_, Contains("source 'dau' of bench 'b' has sent nothing for 5 s; waiting for "
                                 "it up to 120 s (the output is off)"));
}

TEST_F(StepSequenceTest, ASourceThatDoesNotComeBackEndsTheRun) {
  clock_.at(4s, [this] {
    health_ = wire::HEALTH_WAITING;
    message_ = "source 'dau' is away";
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "source 'dau' is away");
  EXPECT_GT(clock_.elapsed(), 4s + StepSequence::away_limit);
  EXPECT_LT(clock_.elapsed(), 4s + StepSequence::away_limit + 5s);
}

// ---- the generator is away

TEST_F(StepSequenceTest, AGeneratorThatDoesNotAnswerIsSwitchedOffAsSoonAsItDoes) {
  bench_.excitation.duration_s = 10.0;
  away_between(14s, 44s);
  clock_.at(40s, [this] { EXPECT_TRUE(instrument_.on); }); // nobody reaches it
  clock_.at(46s, [this] { EXPECT_FALSE(instrument_.on && excited_.back() == Attempt(2, 1)); });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_FALSE(outcome.output_may_be_on);
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  EXPECT_THAT(outcome.pauses.at(0).reason, StartsWith("the instrument does not answer; waiting"));
  EXPECT_THAT(notices_, Contains(HasSubstr("THE OUTPUT OF THE GENERATOR MAY BE ON")));
}

TEST_F(StepSequenceTest, AGeneratorThatDoesNotComeBackEndsTheRunAndIsNamed) {
  away_between(4s, 2000s);
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "the instrument does not answer");
  EXPECT_TRUE(outcome.output_may_be_on);
  EXPECT_TRUE(outcome.output_is_guarded);
  EXPECT_GT(clock_.elapsed(), 4s + StepSequence::away_limit);
  EXPECT_LT(clock_.elapsed(), 4s + StepSequence::away_limit + 15s);
  EXPECT_EQ(state_, wire::MEASUREMENT_ABORTED);
}

TEST_F(StepSequenceTest, APersonWhoCannotConfirmIsNotWaitedFor) {
  bench_.generator.driver = GeneratorDriver::by_hand;
  away_between(4s, 2000s);
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "the instrument does not answer");
  EXPECT_LT(clock_.elapsed(), 20s);
}

TEST_F(StepSequenceTest, NoStepIsBegunBeforeAPersonHasConfirmedThatTheOutputIsOff) {
  bench_.generator.driver = GeneratorDriver::by_hand;
  bench_.excitation.duration_s = 10.0;
  clock_.at(14s, [this] {
    instrument_.confirmed = false;
    command(wire::COMMAND_PAUSE);
  });
  clock_.at(30s, [this] { command(wire::COMMAND_CONTINUE); });
  clock_.at(300s, [this] {
    EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}));
    EXPECT_THAT(messages_,
                Contains("the operator has to confirm that the output is off (THE OUTPUT OF THE "
                         "GENERATOR MAY BE ON, switch it off by hand if you can)"));
    instrument_.confirmed = true;
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_FALSE(outcome.output_may_be_on);
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
}

TEST_F(StepSequenceTest, ARunThatEndsBeforeAPersonHasConfirmedSaysThatTheOutputMayBeOn) {
  bench_.generator.driver = GeneratorDriver::by_hand;
  clock_.at(4500ms, [this] {
    instrument_.confirmed = false;
    stop_.request_stop();
  });
  const RunOutcome outcome = conduct();
  EXPECT_TRUE(outcome.interrupted);
  EXPECT_TRUE(outcome.output_may_be_on);
  EXPECT_FALSE(outcome.output_is_guarded);
}

TEST_F(StepSequenceTest, ALossOfGeneratorAndAnalysisAtOnceIsWaitedOut) { // the operator's link
  bench_.excitation.duration_s = 10.0;
  away_between(14s, 34s);
  silent_between(14s, 37s);
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  ASSERT_EQ(outcome.pauses.size(), 2U);
  EXPECT_THAT(outcome.pauses[0].reason, HasSubstr("does not answer"));
  EXPECT_THAT(outcome.pauses[1].reason, HasSubstr("has gone silent"));
  EXPECT_EQ(outcome.pauses[0].ended_utc_ns, outcome.pauses[1].began_utc_ns);
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
}

// ---- a fault of a device in a step

TEST_F(StepSequenceTest, AStepWithASettingThatIsRefusedOnceIsRepeatedAtTheEnd) {
  instrument_.failing_call = "set_frequency";
  instrument_.failing_from = 2;
  instrument_.failing_times = 1;
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{2, 2}));
  EXPECT_THAT(aborted_, ElementsAre(Attempt{2, 1}));
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  EXPECT_THAT(outcome.pauses, IsEmpty());
  EXPECT_THAT(notices_, Contains("step 2, 80 Hz: set_frequency was refused; the step is broken "
                                 "off, the run goes on"));
}

TEST_F(StepSequenceTest, AStepThatIsRefusedInEveryAttemptIsNamedAndTheOthersAreMeasured) {
  instrument_.refused_hz = "80";
  evaluate_ = [](Attempt attempt) {
    wire::CalibrationResult result = good(attempt);
    result.valid(attempt.first != 2);
    return result;
  };
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "step 2, 80 Hz: 80 Hz was refused (attempts: 3)");
  EXPECT_EQ(state_, wire::MEASUREMENT_ABORTED);
  EXPECT_FALSE(instrument_.on);
  EXPECT_FALSE(outcome.output_may_be_on);
  EXPECT_THAT(aborted_, ElementsAre(Attempt{2, 1}, Attempt{2, 2}, Attempt{2, 3}));
  ASSERT_EQ(outcome.results.size(), 3U);
  EXPECT_TRUE(outcome.results[0].valid);
  EXPECT_TRUE(outcome.results[2].valid);
}

TEST_F(StepSequenceTest, ALevelThatIsNotReachedBreaksOffItsStepAlone) {
  bench_.generator.level_tolerance_rel = 0.01; // and no source shows the level
  bench_.excitation.attempts = 2;
  const RunOutcome outcome = conduct();
  EXPECT_THAT(outcome.problem, StartsWith("step 1, 40 Hz: of acs/reference no whole window "));
  EXPECT_THAT(outcome.problem, testing::EndsWith("(attempts: 2); steps that failed as well: 2"));
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{1, 2},
                                    Attempt{2, 2}, Attempt{3, 2}));
  EXPECT_FALSE(instrument_.on);
}

TEST_F(StepSequenceTest, NoStepIsBegunBeforeTheOutputIsKnownToBeOff) {
  instrument_.failing_call = "set_output(false)";
  instrument_.failing_times = 20;
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(attempts_of(outcome), ElementsAre(2, 1, 1));
  ASSERT_EQ(outcome.pauses.size(), 1U);
  EXPECT_THAT(outcome.pauses[0].reason, HasSubstr("THE OUTPUT OF THE GENERATOR MAY BE ON"));
  EXPECT_GT(outcome.pauses[0].ended_utc_ns - outcome.pauses[0].began_utc_ns, 15'000'000'000);
}

// ---- commands

TEST_F(StepSequenceTest, APauseSwitchesTheOutputOffForAsLongAsItLasts) {
  bench_.excitation.duration_s = 10.0;
  clock_.at(14s, [this] { command(wire::COMMAND_PAUSE); });
  for (int s = 16; s < 900; ++s) {
    clock_.at(std::chrono::seconds(s), [this] { EXPECT_FALSE(instrument_.on); });
  }
  clock_.at(900s, [this] {
    command(wire::COMMAND_CONTINUE);
    command(wire::COMMAND_CONTINUE);
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  ASSERT_EQ(outcome.pauses.size(), 1U);
  EXPECT_EQ(outcome.pauses[0].reason, "paused by a command of 'ada@desk' (the output is off)");
  EXPECT_THAT(messages_, Contains("paused by a command of 'ada@desk' (the output is off)"));
}

TEST_F(StepSequenceTest, AnAnalysisThatDiesInAPauseIsWaitedForFromThenOn) {
  clock_.at(4s, [this] { command(wire::COMMAND_PAUSE); });
  silent_between(400s, 400s + StepSequence::away_limit - 2s);
  clock_.at(600s, [this] { command(wire::COMMAND_CONTINUE); });
  EXPECT_EQ(conduct().problem, "");
}

TEST_F(StepSequenceTest, AnAbortEndsTheRunWithWhatThereIs) {
  bench_.excitation.duration_s = 10.0;
  clock_.at(14s, [this] { command(wire::COMMAND_ABORT); });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "ended by a command of 'ada@desk'");
  EXPECT_EQ(state_, wire::MEASUREMENT_ABORTED);
  EXPECT_THAT(messages_, Contains("ended by a command of 'ada@desk'"));
  EXPECT_LT(clock_.elapsed(), 18s);
  EXPECT_EQ(outcome.results.front().step, 1U);
}

TEST_F(StepSequenceTest, AnAbortBeforeTheFirstStepIsNoPause) {
  clock_.at(0s, [this] { command(wire::COMMAND_ABORT); });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "ended by a command of 'ada@desk'");
  EXPECT_THAT(excited_, IsEmpty());
  EXPECT_THAT(outcome.pauses, IsEmpty());
}

TEST_F(StepSequenceTest, AStepIsRepeatedOnceOnRequestHoweverOftenTheCommandComes) {
  bench_.excitation.attempts = 1;
  for (const auto at : {1s, 2s, 3s, 8s}) {
    clock_.at(at, [this] { command(wire::COMMAND_REPEAT, 1); });
  }
  clock_.at(4s, [this] { command(wire::COMMAND_REPEAT, 99); });
  const RunOutcome outcome = conduct();
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{1, 2}));
  EXPECT_THAT(attempts_of(outcome), ElementsAre(2, 1, 1));
  EXPECT_THAT(notices_, Contains("step 1 is excited again, attempt 2: asked for"));
}

TEST_F(StepSequenceTest, AStopEndsAPauseAtOnce) {
  clock_.at(4s, [this] { command(wire::COMMAND_PAUSE); });
  clock_.at(20s, [this] { stop_.request_stop(); });
  const RunOutcome outcome = conduct();
  EXPECT_TRUE(outcome.interrupted);
  EXPECT_LT(clock_.elapsed(), 21s);
  EXPECT_FALSE(instrument_.on);
}

// ---- repeats

TEST_F(StepSequenceTest, AStepWithALossIsRepeatedUntilItIsWithout) {
  evaluate_ = [](Attempt attempt) {
    return attempt.first == 2 && attempt.second < 3 ? lossy(attempt) : good(attempt);
  };
  const RunOutcome outcome = conduct();
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{2, 2},
                                    Attempt{2, 3}));
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 3, 1));
  EXPECT_EQ(outcome.results[1].lost, 0U);
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(repeated_steps_, ElementsAre(2, 2));
  EXPECT_THAT(notices_, ElementsAre("step 2 is excited again, attempt 2: 50 samples lost",
                                    "step 2 is excited again, attempt 3: 50 samples lost"));
}

TEST_F(StepSequenceTest, AStepThatStaysBadHasAsManyAttemptsAsTheBenchFileAllows) {
  bench_.excitation.attempts = 4;
  evaluate_ = [](Attempt attempt) { return attempt.first == 1 ? lossy(attempt) : good(attempt); };
  const RunOutcome outcome = conduct();
  EXPECT_THAT(attempts_of(outcome), ElementsAre(4, 1, 1));
  EXPECT_EQ(outcome.results[0].lost, 50U); // as it is
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
}

TEST_F(StepSequenceTest, WithOneAttemptNothingIsRepeated) {
  bench_.excitation.attempts = 1;
  evaluate_ = lossy;
  EXPECT_THAT(attempts_of(conduct()), ElementsAre(1, 1, 1));
}

TEST_F(StepSequenceTest, AnAttemptIsAnnouncedOnlyAfterTheResultsOfTheOneBefore) {
  evaluate_ = [this](Attempt attempt) {
    if (attempt == Attempt{3, 1}) { // comes late
      clock_.at(clock_.elapsed() + 15s, [this] {
        EXPECT_EQ(excited_.size(), 3U);
        analysis_.publish(lossy({3, 1}));
      });
      return wire::CalibrationResult{};
    }
    return good(attempt);
  };
  EXPECT_THAT(attempts_of(conduct()), ElementsAre(1, 1, 2));
}

// A changed packet took the place of the message: counts of results do not tell that it is missing.
TEST_F(StepSequenceTest, TheResultOfARepeatThatWasMissedIsCollectedOnceMore) {
  evaluate_ = [](Attempt attempt) {
    return attempt == Attempt{2, 1} ? lossy(attempt) : good(attempt);
  };
  bool missed = false;
  network_.lose([&](const bus::MessageInTransit& message) {
    return message.topic == bus::topics::calibration_result.name &&
           message.as<wire::CalibrationResult>().attempt() == 2 && !std::exchange(missed, true);
  });
  const RunOutcome outcome = conduct();
  EXPECT_TRUE(missed);
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
  EXPECT_EQ(outcome.results[1].lost, 0U);
  EXPECT_EQ(outcome.problem, "");
}

TEST_F(StepSequenceTest, ARunWhoseResultsDoNotComeEndsWithoutRepeats) {
  evaluate_ = [](Attempt attempt) {
    return attempt.first == 3 ? wire::CalibrationResult{} : lossy(attempt);
  };
  const RunOutcome outcome = conduct();
  EXPECT_EQ(excited_.size(), 3U);
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
  EXPECT_GT(clock_.elapsed(), StepSequence::results_limit);
}

TEST_F(StepSequenceTest, ARepeatIsPausedAndBrokenOffLikeAnyStep) {
  bench_.excitation.duration_s = 10.0;
  evaluate_ = [](Attempt attempt) {
    return attempt == Attempt{1, 1} ? lossy(attempt) : good(attempt);
  };
  silent_between(40s, 50s); // the repeat begins at about 35 s
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, "");
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 1}, Attempt{2, 1}, Attempt{3, 1}, Attempt{1, 2},
                                    Attempt{1, 3}));
  EXPECT_THAT(aborted_, ElementsAre(Attempt{1, 2}));
  EXPECT_THAT(attempts_of(outcome), ElementsAre(3, 1, 1));
}

// ---- resumed

TEST_F(StepSequenceTest, AResumedRunGoesOnBehindTheResultsThatAreThere) {
  published_[1] = good({1, 1});
  analysis_.publish(good({1, 1}));
  const auto outcome = try_to_resume();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  // The second step may have been excited when the conductor died.
  EXPECT_THAT(excited_, ElementsAre(Attempt{2, 1}, Attempt{3, 1}, Attempt{2, 2}));
  EXPECT_THAT(aborted_, ElementsAre(Attempt{2, 1}));
  EXPECT_THAT(attempts_of(*outcome), ElementsAre(1, 2, 1));
  EXPECT_THAT(notices_, Contains("run 'r1' is resumed, with 1 results so far"));
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
}

// Conductor and analysis have died together: which steps are left shows when the next analysis has
// evaluated what the sources have kept.
TEST_F(StepSequenceTest, AResumedRunWaitsUntilTheAnalysisKnowsWhatWasMeasured) {
  silent_ = true; // played here until it is done
  clock_.every(1s, [this] {
    if (silent_ && clock_.elapsed() < 200s) {
      analysis_.report(wire::ARM_ARMED, wire::HEALTH_WAITING,
                       fmt::format("taking the run over: {} messages", clock_.elapsed() / 1s));
    } else if (silent_) {
      published_[1] = good({1, 1});
      analysis_.publish(good({1, 1}));
      silent_ = false;
    }
  });
  const auto outcome = try_to_resume();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  EXPECT_THAT(excited_, ElementsAre(Attempt{2, 1}, Attempt{3, 1}, Attempt{2, 2}));
  EXPECT_THAT(notices_, Contains("run 'r1' is resumed, with 1 results so far"));
}

TEST_F(StepSequenceTest, NothingIsExcitedWhileAnotherAnalysisTakesTheRunOver) {
  bench_.excitation.duration_s = 10.0;
  silent_between(14s, 220s); // in the second step
  clock_.every(1s, [this] {
    if (clock_.elapsed() > 20s && clock_.elapsed() < 220s) {
      EXPECT_FALSE(instrument_.on);
      analysis_.report(wire::ARM_ARMED, wire::HEALTH_WAITING,
                       fmt::format("taking the run over: {} messages", clock_.elapsed() / 1s));
    }
  });
  const RunOutcome outcome = conduct();
  EXPECT_EQ(outcome.problem, ""); // it reports that it is at work
  ASSERT_EQ(outcome.pauses.size(), 2U);
  EXPECT_THAT(outcome.pauses[0].reason, HasSubstr("has gone silent"));
  EXPECT_THAT(outcome.pauses[1].reason, HasSubstr("taking the run over"));
  EXPECT_EQ(std::count_if(notices_.begin(), notices_.end(),
                          [](const std::string& notice) {
                            return notice.find("taking the run over") != std::string::npos;
                          }),
            1);
  EXPECT_THAT(attempts_of(outcome), ElementsAre(1, 2, 1));
}

TEST_F(StepSequenceTest, ARunThatDiedInARepeatIsResumedThere) {
  for (const Attempt& attempt : {Attempt{1, 1}, Attempt{2, 2}, Attempt{3, 1}}) {
    published_[attempt.first] = attempt.first == 1 ? lossy(attempt) : good(attempt);
    analysis_.publish(published_[attempt.first]);
  }
  const auto outcome = try_to_resume();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_THAT(excited_, ElementsAre(Attempt{1, 2}));
  EXPECT_THAT(attempts_of(*outcome), ElementsAre(2, 2, 1));
}

TEST_F(StepSequenceTest, ARunThatNobodyHoldsIsNotResumed) {
  silent_ = true;
  const auto outcome = try_to_resume();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().message,
            "no analysis service holds run 'r1' of bench 'b'; begin a new run");
  EXPECT_EQ(instrument_.connections, 0);
}

TEST_F(StepSequenceTest, OfARunThatHasEndedTheResultsAreCollected) {
  finished_ = true;
  for (const std::uint32_t step : {1U, 2U, 3U}) {
    analysis_.publish(good({step, 1}));
  }
  clock_.at(1s, [this] { analysis_.report(wire::ARM_FINISHED); });
  const auto outcome = try_to_resume();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  EXPECT_EQ(outcome->results.size(), 3U);
  follow_run();
  EXPECT_EQ(state_, wire::MEASUREMENT_DONE);
  EXPECT_THAT(notices_, Contains("run 'r1' has ended at the analysis service analysis@test:1; its "
                                 "results are collected"));
  EXPECT_EQ(instrument_.connections, 0);
}

TEST_F(StepSequenceTest, OfARunThatHasEndedTheMissingStepsAreNamed) {
  finished_ = true;
  analysis_.publish(good({1, 1}));
  clock_.at(1s, [this] { analysis_.report(wire::ARM_FINISHED); });
  const auto outcome = try_to_resume();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "run 'r1' had ended at the analysis service analysis@test:1 before 2 "
                              "of its 3 steps; begin a new run for those");
  EXPECT_EQ(outcome->results.size(), 1U);
  follow_run();
  EXPECT_EQ(state_, wire::MEASUREMENT_ABORTED);
  EXPECT_EQ(instrument_.connections, 0);
}

TEST_F(StepSequenceTest, AnEndedRunOfAnotherBenchFileIsNotTakenForThisOne) {
  bench_.sha256 = "new";
  finished_ = true;
  wire::CalibrationResult result = good({1, 1});
  result.recipe_sha256("old");
  analysis_.publish(result);
  clock_.at(1s, [this] { analysis_.report(wire::ARM_FINISHED); });
  const auto outcome = try_to_resume();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::bad_file);
}

TEST_F(StepSequenceTest, ARunOfAnotherBenchFileIsNotResumed) {
  bench_.sha256 = "new";
  wire::CalibrationResult result = good({1, 1});
  result.recipe_sha256("old");
  analysis_.publish(result);
  const auto outcome = try_to_resume();
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::bad_file);
  EXPECT_EQ(instrument_.connections, 0);
}

} // namespace
} // namespace dyncal::services
