// Steps that are excited again after the planned ones: found behind all others, and their results
// take the place of those before.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Ne;

using State = StepAnnouncement::State;

using Pair = std::pair<std::uint32_t, std::uint32_t>; // step and attempt

constexpr double first_block_samples = 50.0 * 997e-6; // of the DAU, s

// Steps 1 and 2 are planned, at 40 and 80 Hz; what is excited is `played`, 2 s each.
class RepeatedSteps : public testing::TestWithParam<bool> {
protected:
  void play(std::vector<tests::SyntheticStep> played, EvaluationLimits limits = {},
            std::size_t lost_block = 0) {
    const tests::SyntheticRun planned;
    const tests::SyntheticRun run{.steps = std::move(played), .lost_block = lost_block};
    limits.ahead = GetParam();
    evaluator_.emplace(*parse_recipe(planned.measurement()), limits);
    ASSERT_TRUE(tests::describe(*evaluator_, run.acs_description()));
    ASSERT_TRUE(tests::describe(*evaluator_, run.dau_description()));
    acs_ = run.acs_blocks();
    dau_ = run.dau_blocks();
    acs_.back().end_of_stream(false);
    dau_.back().end_of_stream(false);
  }
  // What the sources send until then, and what came out meanwhile.
  void send_until(double time_s) {
    const auto until = static_cast<std::size_t>(time_s / first_block_samples);
    for (; sent_ < until && sent_ < std::min(acs_.size(), dau_.size()); ++sent_) {
      tests::feed(*evaluator_, dau_[sent_]);
      while (acs_sent_ <= sent_ &&
             first_block_samples * static_cast<double>(sent_ - acs_sent_) >= acs_late_s_) {
        tests::feed(*evaluator_, acs_[acs_sent_++]);
      }
      take();
    }
  }
  void announce(std::uint32_t step, State state, std::uint32_t attempt = 1) {
    evaluator_->announce({.step = step, .state = state, .attempt = attempt});
    take();
  }
  void excite(std::uint32_t step, double until_s, std::uint32_t attempt = 1) {
    announce(step, State::excited, attempt);
    send_until(until_s);
    announce(step, State::done, attempt);
  }
  void take() {
    for (bool any = true; any;) {
      EvaluationOutput output = evaluator_->take_output();
      any = !output.results.empty();
      std::move(output.results.begin(), output.results.end(), std::back_inserter(results_));
      settled_.insert(settled_.end(), output.settled.begin(), output.settled.end());
      std::move(output.transfer_functions.begin(), output.transfer_functions.end(),
                std::back_inserter(functions_));
    }
  }
  void end() {
    evaluator_->end_of_excitation(false);
    take();
  }
  [[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> steps_and_attempts() const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> all;
    for (const StepResult& result : results_) {
      all.emplace_back(result.step, result.attempt);
    }
    return all;
  }

  std::optional<RunEvaluator> evaluator_;
  std::vector<wire::SampleBlock> acs_;
  std::vector<wire::SampleBlock> dau_;
  std::size_t sent_ = 0;
  std::size_t acs_sent_ = 0;
  double acs_late_s_ = 0.0; // that its samples come behind those of the DAU
  std::vector<StepResult> results_;
  std::vector<StepResult> settled_;
  std::vector<TransferFunction> functions_;
};

INSTANTIATE_TEST_SUITE_P(AheadOfTheEndOrNot, RepeatedSteps, testing::Bool());

TEST_P(RepeatedSteps, AConductedRunIsNotFinishedBeforeItsExcitationIsOver) {
  play({{"40", 10.0}, {"80", 10.0}, {"40", 0.0}});
  excite(1, 2.3);
  excite(2, 5.0);
  EXPECT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}));
  EXPECT_FALSE(evaluator_->finished());
  EXPECT_TRUE(functions_.empty());
  end();
  EXPECT_TRUE(evaluator_->finished());
  ASSERT_EQ(functions_.size(), 1U);
  EXPECT_EQ(functions_[0].points.size(), 2U);
}

TEST_P(RepeatedSteps, AStepThatWasBrokenOffBeforeItShowedSaysSo) {
  play({{"40", 10.0}, {"80", 0.0}, {"40", 0.0}, {"40", 0.0}, {"40", 0.0}});
  excite(1, 2.3);
  announce(2, State::excited);
  announce(2, State::aborted);
  send_until(9.9);
  end();
  ASSERT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}));
  EXPECT_THAT(results_[1].problem, HasSubstr("in acs/sync: its excitation was broken off"));
}

// The conductor has died in step 1, and somebody makes a sine of the next step's frequency by hand.
TEST_P(RepeatedSteps, ASineOfAStepThatWasNotAnnouncedIsNotTakenForIt) {
  play({{"40", 10.0}, {"80", 10.0}, {"40", 0.0}, {"40", 0.0}, {"40", 0.0}});
  excite(1, 2.3);
  send_until(9.9);
  EXPECT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}));
  evaluator_->end_of_excitation(true);
  evaluator_->finish_now();
  take();
  EXPECT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}));
  EXPECT_TRUE(evaluator_->finished());
}

TEST_P(RepeatedSteps, AStepIsFoundWhoseAnnouncementComesBehindItsSamples) {
  play({{"40", 10.0}, {"80", 10.0}, {"40", 0.0}, {"40", 0.0}, {"40", 0.0}});
  excite(1, 2.3);
  send_until(9.9);
  excite(2, 9.9);
  EXPECT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}));
  EXPECT_TRUE(results_.back().valid) << results_.back().problem;
}

// As where the run is taken over from a service that has died: all samples come before what was
// announced about them.
TEST_P(RepeatedSteps, ARepeatIsNotTakenForAStepThatWasNeverFound) {
  play({{"40", 0.0}, {"80", 10.0}, {"40", 10.0}, {"40", 0.0}}, {.behind = true});
  evaluator_->expect_announcements();
  send_until(6.3);
  EXPECT_THAT(steps_and_attempts(), Each(Ne(Pair{1, 2}))) << "not announced yet";
  evaluator_->announce({.step = 1, .state = State::done, .attempt = 2, .repeated_steps = {1}});
  send_until(7.9);
  end();
  ASSERT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}, Pair{1, 2}));
  EXPECT_FALSE(results_[0].valid);
  EXPECT_THAT(results_[0].problem, HasSubstr("no steady sine of 40 Hz"));
  EXPECT_TRUE(results_[1].valid) << results_[1].problem;
  EXPECT_TRUE(results_[2].valid) << results_[2].problem;
  EXPECT_NEAR(results_[2].magnitude, 0.95, 1e-3);
}

TEST_P(RepeatedSteps, AStepInItsPlaceIsFoundWhereARunIsTakenOver) {
  play({{"40", 10.0}, {"80", 10.0}, {"40", 10.0}, {"40", 0.0}}, {.behind = true});
  evaluator_->expect_announcements();
  send_until(6.3);
  evaluator_->announce({.step = 1, .state = State::done, .attempt = 2, .repeated_steps = {1}});
  send_until(7.9);
  end();
  ASSERT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}, Pair{1, 2}));
  for (const StepResult& result : results_) {
    EXPECT_TRUE(result.valid) << result.problem;
  }
}

TEST_P(RepeatedSteps, AStepWithALossIsReplaced) {
  play({{"40", 10.0}, {"80", 10.0}, {"40", 10.0}}, {}, 22); // about 1.1 s: in the first
  excite(1, 2.3);
  excite(2, 4.3);
  ASSERT_EQ(results_.size(), 2U);
  EXPECT_EQ(results_[0].lost, 50U);
  excite(1, 6.5, 2);
  EXPECT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}, Pair{1, 2}));
  EXPECT_TRUE(results_[2].valid) << results_[2].problem;
  EXPECT_EQ(results_[2].lost, 0U);
  EXPECT_THAT(results_[2].flags, IsEmpty());
  EXPECT_NEAR(results_[2].magnitude, 0.95, 1e-3);
  end();
  ASSERT_EQ(functions_.size(), 1U);
  EXPECT_EQ(functions_[0].lost, 0U); // of the results that count
  ASSERT_EQ(functions_[0].points.size(), 2U);
  EXPECT_EQ(functions_[0].points[0].mean.repetitions, 1U);
  EXPECT_EQ(functions_[0].points[0].mean.magnitude, results_[2].magnitude);
}

// 40 Hz was never there in its turn: broken off before anything was steady.
TEST_P(RepeatedSteps, AStepThatWasBrokenOffIsMeasuredAgain) {
  play({{"40", 0.0}, {"80", 10.0}, {"40", 0.0}, {"40", 0.0}, {"40", 10.0}});
  announce(1, State::excited);
  send_until(1.0);
  announce(1, State::aborted);
  send_until(2.4);
  excite(2, 8.0);
  ASSERT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}));
  EXPECT_FALSE(results_[0].valid);
  EXPECT_TRUE(results_[1].valid) << results_[1].problem;
  excite(1, 11.0, 2);
  ASSERT_EQ(results_.size(), 3U);
  EXPECT_TRUE(results_[2].valid) << results_[2].problem;
  EXPECT_THAT(results_[2].flags, IsEmpty());
  end();
  EXPECT_EQ(functions_.at(0).points.size(), 2U);
}

TEST_P(RepeatedSteps, TwoStepsAreRepeatedInTurnAndOneOfThemAgain) {
  play({{"40", 10.0}, {"80", 10.0}, {"80", 10.0}, {"40", 10.0}, {"80", 10.0}});
  excite(1, 2.3);
  excite(2, 4.3);
  excite(2, 6.3, 2);
  excite(1, 8.3, 2);
  excite(2, 10.4, 3);
  EXPECT_THAT(steps_and_attempts(),
              ElementsAre(Pair{1, 1}, Pair{2, 1}, Pair{2, 2}, Pair{1, 2}, Pair{2, 3}));
  for (const StepResult& result : results_) {
    EXPECT_TRUE(result.valid) << result.problem;
  }
  end();
  ASSERT_EQ(functions_.at(0).points.size(), 2U);
  EXPECT_EQ(functions_[0].points[0].mean.magnitude, results_[3].magnitude);
  EXPECT_EQ(functions_[0].points[1].mean.magnitude, results_[4].magnitude);
}

TEST_P(RepeatedSteps, AnAttemptOfWhichNothingComesIsGivenUpAndTakesThePlace) {
  play({{"40", 10.0}, {"80", 10.0}, {"40", 0.0}, {"40", 0.0}, {"40", 0.0}, {"40", 0.0}});
  excite(1, 2.3);
  excite(2, 4.3);
  excite(1, 6.0, 2);
  EXPECT_EQ(results_.size(), 2U);
  send_until(12.0); // 5 s of the sources' own time after its end
  ASSERT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}, Pair{1, 2}));
  EXPECT_FALSE(results_[2].valid);
  end();
  EXPECT_EQ(functions_.at(0).points.size(), 1U);
}

// The ACS is so late that the first attempt is given up before its samples come: they are not taken
// for those of the second one, whose level is another.
TEST_P(RepeatedSteps, AnAttemptIsNotTakenForTheNextOneWhereItsSamplesComeLate) {
  std::vector<tests::SyntheticStep> played(16, {"40", 0.0});
  played[0] = {"40", 10.0};
  played[5] = {"80", 10.0};
  played[9] = {"80", 30.0};
  play(played);
  excite(1, 2.3);
  acs_late_s_ = 7.5;
  send_until(10.3);
  excite(2, 12.3);
  send_until(18.0);
  ASSERT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}));
  EXPECT_FALSE(results_[1].valid) << "given up";
  acs_late_s_ = 0.0;
  excite(2, 20.3, 2);
  send_until(31.0);
  ASSERT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}, Pair{2, 2}));
  EXPECT_TRUE(results_[2].valid) << results_[2].problem;
  EXPECT_NEAR(results_[2].magnitude, 0.95, 1e-3);
  EXPECT_NEAR(results_[2].fits.front().fit.amplitude(), 30.0, 0.1);
}

// Nor of the first step, before which nothing tells how far the clocks are apart but what was
// heard.
TEST_P(RepeatedSteps, AFirstAttemptIsNotTakenForTheNextOneWhereItsSamplesComeLate) {
  std::vector<tests::SyntheticStep> played(16, {"80", 0.0});
  played[4] = {"40", 10.0};
  played[9] = {"40", 30.0};
  play(played);
  send_until(2.0);
  acs_late_s_ = 7.5;
  send_until(8.3);
  excite(1, 10.3);
  send_until(17.0);
  ASSERT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}));
  EXPECT_FALSE(results_[0].valid) << "given up";
  acs_late_s_ = 0.0;
  send_until(18.0);
  announce(2, State::excited);
  announce(2, State::aborted);
  send_until(18.2);
  excite(1, 20.3, 2);
  send_until(27.0);
  ASSERT_FALSE(results_.empty());
  EXPECT_EQ(results_.back().attempt, 2U);
  EXPECT_TRUE(std::isnan(results_.back().magnitude) ||
              std::abs(results_.back().magnitude - 0.95) < 1e-3)
      << results_.back().magnitude;
}

TEST_P(RepeatedSteps, AnAttemptIsFoundThatIsAnnouncedAfterItsSamples) {
  play({{"40", 10.0}, {"80", 10.0}, {"40", 10.0}, {"40", 0.0}});
  excite(1, 2.3);
  excite(2, 4.3);
  send_until(7.0);
  ASSERT_EQ(results_.size(), 2U);
  announce(1, State::done, 2);
  EXPECT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}, Pair{1, 2}));
  EXPECT_TRUE(results_.back().valid) << results_.back().problem;
}

TEST_P(RepeatedSteps, WhoHearsOfTheLastAttemptAloneKnowsOfTheOthers) {
  play({{"40", 10.0}, {"80", 10.0}, {"80", 10.0}, {"40", 10.0}});
  send_until(8.4);
  EXPECT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}));
  EXPECT_TRUE(evaluator_->finished()); // nobody conducts, as far as is known
  play({{"40", 10.0}, {"80", 10.0}, {"80", 10.0}, {"40", 10.0}});
  results_.clear();
  sent_ = 0;
  acs_sent_ = 0;
  evaluator_->announce(
      {.step = 1, .state = State::excited, .attempt = 2, .repeated_steps = {2, 1}});
  send_until(8.4);
  EXPECT_THAT(steps_and_attempts(), ElementsAre(Pair{1, 1}, Pair{2, 1}, Pair{2, 2}, Pair{1, 2}));
}

TEST_P(RepeatedSteps, AnAbortedRunHasTheAttemptsThatWereAnnounced) {
  play({{"40", 10.0}, {"80", 10.0}, {"40", 10.0}});
  excite(1, 2.3);
  excite(2, 4.3);
  announce(1, State::excited, 2);
  send_until(5.6);
  announce(1, State::aborted, 2);
  evaluator_->end_of_excitation(true);
  take();
  EXPECT_FALSE(evaluator_->finished()); // its samples may still come
  evaluator_->finish_now();
  take();
  EXPECT_TRUE(evaluator_->finished());
  ASSERT_EQ(results_.size(), 3U);
  EXPECT_EQ(results_[2].attempt, 2U);
  EXPECT_THAT(names_of(results_[2].flags), Contains("excitation_broken_off"));
}

// The hum of a spoilt attempt bounds nothing, and what was provisional of it is not settled.
TEST_P(RepeatedSteps, OnlyTheLastAttemptIsSettledAtTheEnd) {
  const tests::SyntheticRun planned{.steps = {{"50.2", 10.0}, {"80", 10.0}}};
  const tests::SyntheticRun run{.steps = {{"50.2", 10.0}, {"80", 10.0}, {"50.2", 10.0}}};
  evaluator_.emplace(*parse_recipe(planned.measurement()), EvaluationLimits{.ahead = GetParam()});
  ASSERT_TRUE(tests::describe(*evaluator_, run.acs_description()));
  ASSERT_TRUE(tests::describe(*evaluator_, run.dau_description()));
  acs_ = run.acs_blocks();
  dau_ = run.dau_blocks();
  acs_.back().end_of_stream(false);
  dau_.back().end_of_stream(false);
  excite(1, 2.3);
  excite(2, 4.3);
  excite(1, 6.5, 2);
  ASSERT_EQ(results_.size(), 3U);
  ASSERT_TRUE(results_[0].provisional);
  ASSERT_TRUE(results_[2].provisional);
  end();
  ASSERT_EQ(settled_.size(), 1U);
  EXPECT_EQ(settled_[0].attempt, 2U);
  EXPECT_FALSE(settled_[0].provisional);
}

} // namespace
} // namespace dyncal::inline evaluation
