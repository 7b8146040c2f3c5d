// What a run that is resumed must have in common with the one that was begun, and what of its
// results counts: no other instrument, no other recipe, no attempt that nobody made.
#include "services/run/begun_run.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/base/version.hpp"
#include "services/run/run_controller.hpp"
#include "tests/unit/services/run/played_analysis.hpp"
#include "tests/unit/services/run/played_generator.hpp"
#include "tests/unit/services/run/two_steps.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr const char* channel = "dau/acceleration_x";

class BegunRunTest : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  tests::PlayedAnalysis analysis_{network_, "b", "r1"};
  bus::Participant participant_ = network_.join("runner");
  bus::Participant bench_host_ = network_.join("bench");
  bus::Writer<wire::SourceDescription> descriptions_ =
      bench_host_.writer(bus::topics::source_description, "b").value();
  tests::PlayedInstrument instrument_{clock_};
  std::stop_source stop_;
  std::vector<std::string> notices_;
  std::string failure_;
  bool finished_ = false;
  bool was_announced_ = false;

  static BenchFile bench() {
    BenchFile bench = tests::bench_of_two_steps("b");
    bench.sha256 = "sha";
    return bench;
  }
  void describe(const std::string& source, const std::string& serial) {
    wire::SourceDescription description;
    description.bench("b");
    description.source(source);
    description.device("instrument");
    description.serial(serial);
    descriptions_.write(description);
  }
  static BegunRun begun(const std::string& serial) {
    BegunRun begun{"sha", {}, true};
    begun.sources.push_back({.source = "dau", .software = "", .description = {}});
    begun.sources.back().description.device = "instrument";
    begun.sources.back().description.serial = serial;
    return begun;
  }
  static wire::CalibrationResult result(std::uint32_t step, std::uint32_t attempt, double h) {
    wire::CalibrationResult result;
    result.channel(channel);
    result.step(step);
    result.attempt(attempt);
    result.valid(true);
    result.recipe_sha256("sha");
    result.frequency_hz(40.0 * step);
    result.frequency_text_hz(step == 1 ? "40" : "80");
    result.magnitude(h);
    result.u_magnitude(1e-3);
    result.phase_rad(0.1);
    result.u_phase_rad(1e-3);
    return result;
  }
  // Finishes when the conductor has.
  void play_analysis(wire::ArmState arm = wire::ARM_ARMED) {
    clock_.every(500ms, [this, arm] {
      for (const wire::Measurement& measurement : analysis_.measurements()) {
        was_announced_ = true;
        finished_ = finished_ || measurement.state() == wire::MEASUREMENT_DONE ||
                    measurement.state() == wire::MEASUREMENT_ABORTED;
      }
      analysis_.report(finished_ ? wire::ARM_FINISHED : arm, failure_);
    });
  }
  void describe_both(const std::string& serial) {
    describe("acs", "17");
    describe("dau", serial);
  }
  RunController controller(RunKeeping keeping) {
    RunController controller({participant_, clock_, tests::connect_to(instrument_)}, bench_, "r1",
                             [this](const RunProgress& progress) {
                               if (!progress.notice.empty()) {
                                 notices_.push_back(progress.notice);
                               }
                             });
    keeping.check = [](const RunOutcome& /*planned*/) { return Expected<void>{}; };
    controller.set_keeping(std::move(keeping));
    return controller;
  }
  Expected<RunOutcome> resume(std::optional<BegunRun> begun) {
    return controller({.check = {}, .keep = {}, .begun = std::move(begun)})
        .resume({}, stop_.get_token());
  }
  BenchFile bench_ = bench();
};

TEST_F(BegunRunTest, IsResumedWithTheSameInstrument) {
  play_analysis();
  describe_both("1");
  analysis_.publish(result(1, 1, 1.0));
  clock_.at(3s, [this] { analysis_.publish(result(2, 1, 1.0)); }); // as it was when the other died
  clock_.at(15s, [this] { analysis_.publish(result(2, 2, 1.0)); });
  const auto outcome = resume(begun("1"));
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  EXPECT_EQ(outcome->results.size(), 2U);
  EXPECT_GT(instrument_.connections, 0);
  EXPECT_THAT(notices_, testing::Not(testing::Contains(HasSubstr("left out"))));
}

TEST_F(BegunRunTest, IsNotResumedWithAnotherInstrument) {
  play_analysis();
  describe_both("2");
  const auto outcome = resume(begun("1"));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::no_source);
  EXPECT_EQ(outcome.error().message,
            "run 'r1' is not resumed: source 'dau' is another instrument than the run began with: "
            "now instrument, serial number 2, then instrument, serial number 1; put that one back, "
            "or begin a new run");
  EXPECT_EQ(instrument_.connections, 0);
  EXPECT_LT(clock_.elapsed(), 5s);
}

TEST_F(BegunRunTest, WaitsForTheDescriptionsBeforeItExcites) {
  play_analysis();
  describe("acs", "17");
  clock_.at(2500ms, [this] { describe("dau", "2"); });
  const auto outcome = resume(begun("1"));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::no_source);
  EXPECT_EQ(instrument_.connections, 0);
}

TEST_F(BegunRunTest, IsNotResumedWithAnotherRecipe) {
  play_analysis();
  BegunRun other = begun("1");
  other.recipe_sha256 = "other";
  const auto outcome = resume(other);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::bad_file);
  EXPECT_THAT(outcome.error().message, HasSubstr("(SHA-256 of its recipe other, of this one sha)"));
  EXPECT_FALSE(was_announced_); // nobody is told of it
}

// From another folder: what the run began with, only the analysis knows.
class ElsewhereBegunRun : public BegunRunTest {
protected:
  bus::Writer<wire::Command> commands_ = analysis_.command_writer();
  bus::Writer<wire::Command> persons_commands_ =
      bench_host_.writer(bus::topics::command, "b").value();

  void ask_to_end() { ask_to_end(commands_); }
  // Whoever it says that it is.
  static void ask_to_end(bus::Writer<wire::Command>& commands) {
    wire::Command command;
    command.bench("b");
    command.target("conductor");
    command.kind(wire::COMMAND_ABORT);
    command.run("r1");
    command.sender("ada@desk");
    commands.write(command);
  }
};

// The sensor may have been changed since.
TEST_F(ElsewhereBegunRun, NamesNoInstrumentForWhatAnEndedRunHasMeasured) {
  finished_ = true;
  play_analysis();
  describe_both("2");
  analysis_.publish(result(1, 1, 1.0));
  const auto outcome = resume(std::nullopt);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->results.size(), 1U);
  EXPECT_TRUE(outcome->sources.empty());
  EXPECT_THAT(notices_, testing::Contains(HasSubstr("is not known, and the result names none")));
}

TEST_F(BegunRunTest, NamesTheInstrumentsOfItsFolderForWhatAnEndedRunHasMeasured) {
  finished_ = true;
  play_analysis();
  describe_both("2");
  analysis_.publish(result(1, 1, 1.0));
  const auto outcome = resume(begun("1"));
  ASSERT_TRUE(outcome) << outcome.error().message;
  const auto dau = std::find_if(outcome->sources.begin(), outcome->sources.end(),
                                [](const RunSource& one) { return one.source == "dau"; });
  ASSERT_NE(dau, outcome->sources.end());
  EXPECT_EQ(dau->description.serial, "1");
}

TEST_F(ElsewhereBegunRun, IsRefusedWithinThreeSecondsWithAnotherInstrument) {
  clock_.every(500ms, [this] {
    analysis_.report(wire::ARM_ARMED, wire::HEALTH_WAITING, "source 'dau' is another instrument");
  });
  clock_.at(2200ms, [this] { ask_to_end(); });
  describe_both("2");
  const auto outcome = resume(std::nullopt);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::no_source);
  EXPECT_EQ(outcome.error().message, "run 'r1' is not resumed: source 'dau' is another instrument");
  EXPECT_EQ(instrument_.connections, 0);
  EXPECT_LT(clock_.elapsed(), 3s);
}

TEST_F(ElsewhereBegunRun, IsRefusedWithinThreeSecondsWithAnotherRecipeBeforeItsFirstResult) {
  play_analysis();
  clock_.at(2200ms, [this] { ask_to_end(); }); // it has heard of the run every 2 s
  describe_both("1");
  const auto outcome = resume(std::nullopt);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::bad_file);
  EXPECT_THAT(outcome.error().message, HasSubstr("by another bench file"));
  EXPECT_EQ(instrument_.connections, 0);
  EXPECT_LT(clock_.elapsed(), 3s);
}

TEST_F(ElsewhereBegunRun, IsEndedByAPersonsCommand) {
  clock_.every(500ms, [this] {
    analysis_.report(wire::ARM_ARMED, wire::HEALTH_WAITING, "taking the run over");
  });
  clock_.at(1s, [this] { ask_to_end(persons_commands_); });
  const auto outcome = resume(std::nullopt);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().message,
            "run 'r1' is not resumed: ended by a command of bench: 'ada@desk'");
}

TEST_F(ElsewhereBegunRun, IsResumedAtOnceWhereItsResultsHaveThisRecipe) {
  play_analysis();
  describe_both("1");
  analysis_.publish(result(1, 1, 1.0));
  clock_.at(3s, [this] { analysis_.publish(result(2, 1, 1.0)); });
  clock_.at(15s, [this] { analysis_.publish(result(2, 2, 1.0)); });
  const auto outcome = resume(std::nullopt);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
}

// Its guard has named the run since the other conductor died, and goes on until it hears of a step.
class GuardedBegunRun : public BegunRunTest {
protected:
  bus::Participant guard_host_ = network_.join("guard");
  bus::Writer<wire::ServiceStatus> guard_ =
      guard_host_.writer(bus::topics::service_status, "b").value();
  bool is_deaf_ = true;
  bool stays_deaf_ = false;
  bool was_on_while_deaf_ = false;

  void play_guard() {
    bench_.generator.driver = GeneratorDriver::scpi;
    bench_.generator.address = "192.0.2.7:5025";
    clock_.every(100ms, [this] {
      is_deaf_ = is_deaf_ && (stays_deaf_ || analysis_.excitations().empty());
      wire::ServiceStatus status;
      status.bench("b");
      status.service("guard@lab-2:7");
      status.host("lab-2");
      status.guarded_generator(bench_.generator.address);
      status.run(is_deaf_ ? "r1" : "");
      guard_.write(status);
    });
    clock_.every(
        10ms, [this] { was_on_while_deaf_ = was_on_while_deaf_ || (instrument_.on && is_deaf_); });
  }
};

TEST_F(GuardedBegunRun, IsResumedWhereItsGuardHearsItWithTheFirstStep) {
  play_analysis();
  play_guard();
  describe_both("1");
  analysis_.publish(result(1, 1, 1.0));
  clock_.at(3s, [this] { analysis_.publish(result(2, 1, 1.0)); });
  clock_.at(15s, [this] { analysis_.publish(result(2, 2, 1.0)); });
  const auto outcome = resume(begun("1"));
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  EXPECT_FALSE(is_deaf_);
  EXPECT_FALSE(was_on_while_deaf_);
  EXPECT_LT(clock_.elapsed(), 60s);
}

TEST_F(GuardedBegunRun, PausesAndDrivesNothingWhereItsGuardStaysDeaf) {
  stays_deaf_ = true;
  play_analysis();
  play_guard();
  describe_both("1");
  analysis_.publish(result(1, 1, 1.0));
  clock_.at(3s, [this] { analysis_.publish(result(2, 1, 1.0)); });
  const auto outcome = resume(begun("1"));
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_THAT(outcome->problem, HasSubstr("the dyncal-guard on lab-2 does not hear this run"));
  ASSERT_FALSE(outcome->pauses.empty());
  EXPECT_THAT(outcome->pauses[0].reason, HasSubstr("does not hear this run"));
  EXPECT_FALSE(was_on_while_deaf_);
  EXPECT_GT(clock_.elapsed(), 120s);
}

TEST_F(BegunRunTest, EndedAtTheAnalysisIsCollectedAndKeepsItsInstrument) {
  describe_both("2");
  analysis_.publish(result(1, 1, 1.0));
  analysis_.publish(result(2, 1, 1.0));
  finished_ = true;
  play_analysis();
  const auto outcome = resume(begun("1"));
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->results.size(), 2U);
  ASSERT_FALSE(outcome->sources.empty());
  EXPECT_EQ(outcome->sources.back().description.serial, "1");
}

TEST_F(BegunRunTest, EndedBeforeItsFirstResultIsToBeBegunAnew) {
  failure_ = "source 'dau' no longer has what it sent";
  play_analysis(wire::ARM_REFUSED);
  BegunRun without_results = begun("1");
  without_results.has_results = false;
  const auto nothing = resume(without_results);
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().message,
            "run 'r1' ended before its first result: nothing was measured; begin a new run");
  const auto something = resume(begun("1"));
  ASSERT_FALSE(something);
  EXPECT_EQ(something.error().message, failure_);
}

class ConductedRun : public BegunRunTest {
protected:
  Expected<RunOutcome> conduct() { return controller({}).conduct({}, stop_.get_token()); }
};

TEST_F(ConductedRun, PausesWhileASourceIsAnotherInstrumentAndKeepsItsOwn) {
  play_analysis();
  describe_both("1");
  clock_.at(2s, [this] { describe("dau", "2"); });
  clock_.at(10s, [this] { EXPECT_FALSE(instrument_.on); });
  clock_.at(20s, [this] { describe("dau", "1"); });
  for (const auto second : {30s, 40s, 50s}) {
    clock_.at(second, [this] {
      analysis_.publish(result(1, instrument_.on ? 1 : 2, 1.0));
      analysis_.publish(result(2, 1, 1.0));
    });
  }
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_THAT(notices_, testing::Contains(HasSubstr("is another instrument than the run began")));
  EXPECT_THAT(notices_, testing::Contains(HasSubstr("the run has paused for")));
  ASSERT_EQ(outcome->sources.size(), 2U);
  EXPECT_EQ(outcome->sources.back().description.serial, "1");
}

TEST_F(ConductedRun, LeavesOutAnAttemptThatItNeverMade) {
  play_analysis();
  describe_both("1");
  tests::PlayedAnalysis forger(network_, "b", "r1");
  clock_.at(1s, [&] { forger.publish(result(2, 1, 42.0)); }); // of a step to come
  clock_.at(7s, [&] { forger.publish(result(1, 1, 42.0)); });
  clock_.at(8s, [&] { analysis_.publish(result(1, 9, 42.0)); });
  clock_.at(9s, [&] {
    analysis_.publish(result(1, 1, 1.0));
    analysis_.publish(result(2, 1, 1.0));
  });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_EQ(outcome->results.size(), 2U);
  EXPECT_DOUBLE_EQ(outcome->results[0].magnitude, 1.0);
  EXPECT_DOUBLE_EQ(outcome->results[1].magnitude, 1.0);
  EXPECT_THAT(notices_, testing::Contains(HasSubstr("that it did not plan or excite")));
  EXPECT_THAT(notices_,
              testing::Contains(HasSubstr("publishes about this run and is not its analysis")));
}

TEST_F(ConductedRun, TakesTheAttemptsThatItMade) {
  play_analysis();
  describe_both("1");
  clock_.at(9s, [this] {
    wire::CalibrationResult lossy = result(1, 1, 1.0);
    lossy.lost(3);
    analysis_.publish(lossy);
    analysis_.publish(result(2, 1, 1.0));
  });
  clock_.at(18s, [this] { analysis_.publish(result(1, 2, 2.0)); });
  const auto outcome = conduct();
  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_EQ(outcome->results.size(), 2U);
  EXPECT_EQ(outcome->results[0].attempt, 2U);
  EXPECT_THAT(notices_, testing::Not(testing::Contains(HasSubstr("left out"))));
}

} // namespace
} // namespace dyncal::inline run
