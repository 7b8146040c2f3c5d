// The table of exciter_watch.hpp, line by line, and what is a person's; no time passes but by hand.
#include "services/programs/guard/exciter_watch.hpp"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;
using Action = ExciterWatch::Action;
using State = ExciterWatch::State;

constexpr OutputSettings of_step{40.0, 0.8};
constexpr OutputSettings of_next_step{80.0, 0.8};
constexpr OutputSettings of_person{100.0, 0.8};

// A generator and a guard that does at once what is due.
class ExciterWatchTest : public testing::Test {
protected:
  ExciterWatch::Instant now_{1h};
  ExciterWatch watch_{{of_step, of_next_step}, {}, now_};
  bool is_on_ = false;
  OutputSettings settings_ = of_step;
  bool answers_ = true;
  bool obeys_ = true;
  int questions_ = 0;
  int attempts_ = 0;

  void restart(const DrivenRun& recorded = {}) {
    watch_ = ExciterWatch({of_step, of_next_step}, recorded, now_);
  }
  void say(bool is_driven, const std::string& run = "r1") {
    watch_.heard({run, is_driven, {settings_.frequency_hz, settings_.voltage_vpp}}, now_);
  }
  void drive(const OutputSettings& settings = of_step, const std::string& run = "r1") {
    settings_ = settings;
    say(true, run);
    is_on_ = true;
    pass(100ms);
  }
  void end() {
    is_on_ = false;
    say(false);
    pass(100ms);
  }
  void act() {
    const Action action = watch_.due(now_);
    if (action == Action::ask) {
      ++questions_;
      OutputReading reading;
      reading.is_on = is_on_;
      reading.settings = settings_;
      watch_.answered(
          answers_ ? Expected<OutputReading>(reading) : fail(ErrorCode::device, "no answer"), now_);
    } else if (action == Action::switch_off) {
      ++attempts_;
      const bool goes_off = answers_ && obeys_;
      is_on_ = is_on_ && !goes_off;
      watch_.switched_off(goes_off ? Expected<void>{}
                                   : fail(ErrorCode::device, answers_ ? "STILL ON" : "no answer"),
                          now_);
    }
  }
  void pass(std::chrono::milliseconds time) {
    for (; time > 0ms; time -= 100ms) {
      now_ += 100ms;
      act();
      act();
    }
  }
};

TEST_F(ExciterWatchTest, AsksNothingWhereNothingWasDriven) {
  is_on_ = true;
  pass(300s);
  EXPECT_EQ(questions_, 0);
  EXPECT_TRUE(is_on_);
}

TEST_F(ExciterWatchTest, AsksEverySecondWhileItIsDriven) {
  drive();
  for (int i = 0; i < 100; ++i) {
    say(true);
    pass(500ms);
  }
  EXPECT_GE(questions_, 45);
  EXPECT_LE(questions_, 55);
  EXPECT_EQ(attempts_, 0);
  EXPECT_TRUE(is_on_);
}

TEST_F(ExciterWatchTest, TakesAConductorThatHasLostHoldOfItsGeneratorForNoneWhoAttends) {
  drive();
  pass(1500ms);
  watch_.heard({"r1", true, of_step, false}, now_);
  pass(600ms);
  EXPECT_FALSE(is_on_);
  watch_.heard({"r1", true, of_step, false}, now_); // once more, for a late joiner
  EXPECT_EQ(watch_.state(), State::silent);
  restart();
  is_on_ = true;
  watch_.heard({"r1", true, of_step, false}, now_); // the first word that this guard hears
  pass(2100ms);
  EXPECT_FALSE(is_on_);
}

TEST_F(ExciterWatchTest, SwitchesOffWhatAnUnheardConductorSwitchesOnAgain) {
  drive();
  pass(2s);
  EXPECT_FALSE(is_on_);
  for (const OutputSettings& step : {of_step, of_next_step, of_step}) {
    pass(30s);
    settings_ = step;
    is_on_ = true;
    pass(1100ms);
    EXPECT_FALSE(is_on_);
  }
  EXPECT_EQ(attempts_, 4);
}

TEST_F(ExciterWatchTest, SwitchesOffAnOnThatComesAfterTheRun) {
  drive();
  end();
  pass(100s);
  EXPECT_EQ(attempts_, 0);
  is_on_ = true;
  pass(3100ms);
  EXPECT_FALSE(is_on_);
  EXPECT_EQ(watch_.may_be_on(), "");
  pass(90s); // two minutes begin anew
  is_on_ = true;
  pass(3100ms);
  EXPECT_FALSE(is_on_);
}

TEST_F(ExciterWatchTest, LeavesTheNextStepOnWhoseAnnouncementComesLate) {
  drive();
  end();
  is_on_ = true;
  pass(1900ms);
  say(true);
  pass(500ms);
  EXPECT_TRUE(is_on_);
  EXPECT_EQ(attempts_, 0);
}

TEST_F(ExciterWatchTest, SaysAndLeavesWhatAPersonSwitchesOn) {
  drive();
  end();
  for (const OutputSettings& other : {of_person, OutputSettings{40.0, 0.9}}) {
    settings_ = other;
    is_on_ = true;
    pass(20s);
    EXPECT_TRUE(is_on_);
    EXPECT_EQ(watch_.left_on(), other);
  }
  is_on_ = false;
  pass(2s);
  EXPECT_EQ(watch_.left_on(), std::nullopt);
  EXPECT_EQ(attempts_, 0);
}

TEST_F(ExciterWatchTest, LeavesAPersonsUseInASilenceToo) {
  drive();
  pass(5s);
  EXPECT_EQ(attempts_, 1);
  settings_ = of_person;
  is_on_ = true;
  pass(60s);
  EXPECT_TRUE(is_on_);
  EXPECT_EQ(watch_.left_on(), of_person);
}

TEST_F(ExciterWatchTest, AsksNothingMoreTwoMinutesAfterARunAndAfterASilence) {
  for (const bool ends : {true, false}) {
    drive();
    if (ends) {
      end();
    } else {
      pass(3s);
    }
    pass(121s);
    EXPECT_EQ(watch_.state(), State::idle);
    EXPECT_EQ(watch_.run(), DrivenRun{});
    const int before = questions_;
    is_on_ = true;
    pass(60s);
    EXPECT_EQ(questions_, before);
    EXPECT_TRUE(is_on_);
  }
}

TEST_F(ExciterWatchTest, SwitchesOffAfterItsStartWhatItsRecordNames) {
  is_on_ = true;
  restart({"r1", false, {of_step}});
  pass(1900ms);
  EXPECT_TRUE(is_on_) << "its conductor may be there";
  pass(200ms);
  EXPECT_FALSE(is_on_);
}

TEST_F(ExciterWatchTest, LeavesAfterItsStartWhatItsRecordDoesNotName) {
  settings_ = of_next_step; // planned, but not driven
  is_on_ = true;
  restart({"r1", false, {of_step}});
  pass(300s);
  EXPECT_TRUE(is_on_);
  EXPECT_EQ(attempts_, 0);
  restart();
  pass(300s);
  EXPECT_TRUE(is_on_);
}

// Both hosts lose their power as a run begins, before the guard has heard what is driven.
TEST_F(ExciterWatchTest, SwitchesOffAfterItsStartWhatAConductedRunPlans) {
  for (const bool has_ended : {true, false}) {
    settings_ = of_next_step;
    is_on_ = true;
    restart({"r1", has_ended, {}, true});
    pass(1900ms);
    EXPECT_TRUE(is_on_) << "its conductor may be there";
    pass(1600ms);
    EXPECT_FALSE(is_on_) << has_ended;
    settings_ = of_person;
    is_on_ = true;
    restart({"r1", has_ended, {}, true});
    pass(60s);
    EXPECT_TRUE(is_on_) << has_ended;
  }
}

TEST_F(ExciterWatchTest, LeavesAHealthyRunAloneAfterItsStart) {
  restart({"r1", false, {of_step}});
  is_on_ = true;
  for (int i = 0; i < 100; ++i) {
    pass(500ms);
    say(true);
  }
  EXPECT_EQ(attempts_, 0);
}

TEST_F(ExciterWatchTest, GoesOnUntilTheOutputAnswersThatItIsOff) {
  obeys_ = false;
  drive();
  pass(10min);
  EXPECT_GE(attempts_, 590);
  EXPECT_EQ(watch_.may_be_on(), "STILL ON");
  obeys_ = true;
  pass(1100ms);
  EXPECT_FALSE(is_on_);
  EXPECT_EQ(watch_.may_be_on(), "");
  EXPECT_TRUE(watch_.has_switched_off());
}

TEST_F(ExciterWatchTest, SaysThatItMayBeOnWhereASilentRunsGeneratorDoesNotAnswer) {
  restart({"r1", false, {of_step}});
  answers_ = false;
  pass(2s);
  EXPECT_EQ(watch_.may_be_on(), "");
  pass(100ms); // it was asked before
  EXPECT_EQ(watch_.may_be_on(), "no answer");
  pass(10min);
  EXPECT_EQ(watch_.may_be_on(), "no answer");
  answers_ = true;
  pass(1100ms);
  EXPECT_EQ(watch_.may_be_on(), "");
}

// It answered until the run fell silent.
TEST_F(ExciterWatchTest, SaysSoAfterTheFirstQuestionOfASilenceWithoutAnAnswer) {
  restart({"r1", false, {of_step}});
  settings_ = of_person;
  is_on_ = true;
  pass(2100ms);
  EXPECT_EQ(watch_.state(), State::silent);
  EXPECT_EQ(watch_.may_be_on(), "");
  answers_ = false;
  pass(1100ms);
  EXPECT_EQ(watch_.may_be_on(), "no answer");
  answers_ = true;
  pass(1100ms);
  EXPECT_EQ(watch_.may_be_on(), "");
  EXPECT_TRUE(is_on_) << "a person's";
}

TEST_F(ExciterWatchTest, AsksAGeneratorOfOneConnectionOnceTheConductorIsSilent) {
  answers_ = false;
  drive();
  EXPECT_EQ(questions_, 1);
  for (int i = 0; i < 100; ++i) {
    pass(500ms);
    say(true);
  }
  EXPECT_EQ(questions_, 1);
  EXPECT_EQ(watch_.may_be_on(), "") << "somebody attends";
  answers_ = true;
  pass(2100ms);
  EXPECT_FALSE(is_on_);
  pass(10s);
  EXPECT_GE(questions_, 10);
}

TEST_F(ExciterWatchTest, KnowsTheFrequencyWhereTheVoltageWasNotSeen) {
  answers_ = false;
  watch_.heard({"r1", true, {40.0, std::nullopt}}, now_);
  pass(100ms);
  say(false);
  answers_ = true;
  is_on_ = true;
  pass(5s);
  EXPECT_FALSE(is_on_);
}

TEST_F(ExciterWatchTest, TakesTheLastWordOfARunBeforeForNothing) {
  drive(of_step, "r2");
  say(false, "r1");
  EXPECT_EQ(watch_.state(), State::driven);
  EXPECT_EQ(watch_.run().run, "r2");
  pass(2100ms);
  EXPECT_FALSE(is_on_);
}

// The path fails between the conductor's word and its ON, or before the guard has heard that word.
TEST_F(ExciterWatchTest, SwitchesOffWhatARunSwitchesOnWithoutBeingHeard) {
  for (const bool was_driven : {false, true}) {
    restart();
    if (was_driven) {
      drive();
      end();
    }
    watch_.heard_run("r1", RunPhase::running, now_);
    pass(30s);
    EXPECT_EQ(attempts_, 0);
    settings_ = of_next_step;
    is_on_ = true;
    pass(3500ms);
    EXPECT_FALSE(is_on_) << was_driven;
    attempts_ = 0;
  }
}

TEST_F(ExciterWatchTest, SaysThatARunMayHaveBegunWhoseGeneratorDoesNotAnswer) {
  watch_.heard_run("r1", RunPhase::running, now_);
  answers_ = false;
  pass(2500ms);
  EXPECT_EQ(watch_.may_be_on(), "");
  pass(1100ms);
  EXPECT_EQ(watch_.may_be_on(), "no answer");
  EXPECT_EQ(attempts_, 0) << "it may be a person's";
  answers_ = true;
  pass(1100ms);
  EXPECT_EQ(watch_.may_be_on(), "");
  watch_.heard_run("r1", RunPhase::over, now_);
  answers_ = false;
  pass(10s);
  EXPECT_EQ(watch_.may_be_on(), "");
}

TEST_F(ExciterWatchTest, LeavesWhatIsPlannedToAPersonOnceTheRunIsOver) {
  watch_.heard_run("r1", RunPhase::running, now_);
  drive();
  end();
  watch_.heard_run("r1", RunPhase::over, now_);
  settings_ = of_next_step;
  is_on_ = true;
  pass(60s);
  EXPECT_TRUE(is_on_);
  EXPECT_EQ(watch_.left_on(), of_next_step);
}

TEST_F(ExciterWatchTest, LeavesAPersonsUseInARunThatPauses) {
  watch_.heard_run("r1", RunPhase::running, now_);
  settings_ = of_person;
  is_on_ = true;
  for (int i = 0; i < 100; ++i) {
    pass(2s);
    watch_.heard_run("r1", RunPhase::running, now_);
  }
  EXPECT_TRUE(is_on_);
  EXPECT_EQ(watch_.state(), State::begins);
  EXPECT_EQ(questions_, 0);
}

TEST_F(ExciterWatchTest, TakesARunThatWaitsForItsTurnForNothing) {
  drive();
  end();
  watch_.heard_run("r1", RunPhase::running, now_);
  watch_.heard_run("r2", RunPhase::planned, now_);
  EXPECT_EQ(watch_.run().run, "r1");
  watch_.heard_run("r1", RunPhase::over, now_);
  watch_.heard_run("r2", RunPhase::planned, now_);
  EXPECT_EQ(watch_.run().run, "r2");
  watch_.heard_run("r3", RunPhase::planned, now_);
  EXPECT_EQ(watch_.run().run, "r2");
  watch_.heard_run("r3", RunPhase::running, now_);
  EXPECT_EQ(watch_.run().run, "r3");
  settings_ = {40.0, 0.9}; // a person's
  is_on_ = true;
  pass(10s);
  EXPECT_TRUE(is_on_);
  settings_ = of_step; // of r1, which TCP held
  pass(3500ms);
  EXPECT_FALSE(is_on_);
}

TEST_F(ExciterWatchTest, WatchesARunThatHasNotDrivenForTwoMinutesAfterItsLastWord) {
  watch_.heard_run("r1", RunPhase::running, now_);
  pass(121s);
  EXPECT_EQ(watch_.state(), State::idle);
}

TEST_F(ExciterWatchTest, LetsNoOtherRunStandForOneThatIsDrivenOrSilent) {
  drive();
  watch_.heard_run("r2", RunPhase::running, now_);
  EXPECT_EQ(watch_.run().run, "r1");
  answers_ = false;
  pass(5s);
  EXPECT_NE(watch_.may_be_on(), "");
  watch_.heard_run("r2", RunPhase::running, now_);
  EXPECT_EQ(watch_.run().run, "r1");
  EXPECT_NE(watch_.may_be_on(), "");
}

// Whatever happens in whatever order: no output that must be off stays on for longer than what is
// promised without a word, and nothing of a person is switched off.
TEST_F(ExciterWatchTest, HoldsItsPromiseOverDrawnHistories) {
  std::mt19937 chance(32);
  const auto draw = [&](int count) { return std::uniform_int_distribution(0, count - 1)(chance); };
  int died = 0;
  for (int history = 0; history < 500; ++history) {
    restart();
    is_on_ = false;
    answers_ = obeys_ = true;
    const bool restarts = draw(2) == 0;
    drive(draw(2) == 0 ? of_step : of_next_step);
    for (int i = draw(10); i > 0; --i) {
      say(true);
      pass(500ms);
    }
    if (draw(2) == 0) {
      end();
      pass(std::chrono::milliseconds(100 * draw(500)));
      is_on_ = true; // what TCP held
    }
    ++died;
    const int trouble = draw(4);
    answers_ = trouble != 0;
    obeys_ = trouble != 1;
    if (restarts) {
      const DrivenRun recorded = watch_.run();
      now_ += std::chrono::milliseconds(100 * draw(100));
      restart(recorded);
    }
    pass(5s);
    ASSERT_TRUE(!is_on_ || !watch_.may_be_on().empty() || !answers_) << history;
    answers_ = obeys_ = true;
    pass(3500ms);
    ASSERT_FALSE(is_on_) << history;
    settings_ = of_person;
    is_on_ = true;
    pass(60s);
    ASSERT_TRUE(is_on_) << history;
  }
  EXPECT_EQ(died, 500);
}

} // namespace
} // namespace dyncal::inline programs
