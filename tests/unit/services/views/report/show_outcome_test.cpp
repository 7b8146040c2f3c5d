#include "services/views/report/show_outcome.hpp"

#include <stdlib.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline views {
namespace {

using testing::HasSubstr;

RunOutcome outcome_of_steps(std::size_t planned, std::size_t measured) {
  RunOutcome outcome;
  outcome.planned_steps = planned;
  for (std::uint32_t step = 1; step <= planned; ++step) {
    for (const char* channel : {"dau/x", "dau/y"}) {
      StepResult result;
      result.channel = channel;
      result.step = step;
      result.valid = step <= measured;
      outcome.results.push_back(result);
    }
  }
  return outcome;
}

TEST(ShowOutcome, FilesOfLastResortDoNotReplaceEachOther) {
  const tests::TemporaryFolder folder;
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  setenv("TMPDIR", folder.path().c_str(), 1);
  std::vector<std::string> said;
  for (const std::size_t measured : {1, 2, 3}) {
    RunOutcome outcome = outcome_of_steps(3, measured);
    outcome.bench = "acc-1";
    outcome.run = "first";
    const auto written = write_results(outcome, "/proc/none/result.json");
    ASSERT_FALSE(written);
    said.push_back(written.error().message);
  }
  before == nullptr ? unsetenv("TMPDIR") : setenv("TMPDIR", kept.c_str(), 1);
  EXPECT_THAT(said, testing::ElementsAre(HasSubstr("dyncal-acc-1-first.json"),
                                         HasSubstr("dyncal-acc-1-first-2.json"),
                                         HasSubstr("dyncal-acc-1-first-3.json")));
  for (const char* name : {"", "-2", "-3"}) {
    const auto path = folder.path() / (std::string("dyncal-acc-1-first") + name + ".json");
    EXPECT_GT(std::filesystem::file_size(path), 0U) << path;
  }
}

TEST(ShowOutcome, ARunIsCompleteWhenEveryStepHasAResult) {
  EXPECT_TRUE(check_complete(outcome_of_steps(3, 3)));
}

TEST(ShowOutcome, StepsWithoutAResultAreCounted) {
  const auto checked = check_complete(outcome_of_steps(3, 1));
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::no_result);
  EXPECT_THAT(checked.error().message, HasSubstr("2 of 3 steps have no result"));
}

TEST(ShowOutcome, AChannelWithoutAnyResultIsNamed) {
  RunOutcome outcome = outcome_of_steps(3, 3);
  for (StepResult& result : outcome.results) {
    result.valid = result.channel == "dau/x";
  }
  const auto checked = check_complete(outcome);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::no_result);
  EXPECT_THAT(checked.error().message,
              HasSubstr("1 of the channels under calibration has no result at any step: dau/y"));
  outcome.results[1].valid = true; // at one step is enough: the table shows where
  EXPECT_TRUE(check_complete(outcome));
}

TEST(ShowOutcome, AnInterruptedRunKeepsWhatItMeasured) {
  RunOutcome outcome = outcome_of_steps(3, 1);
  outcome.interrupted = true;
  const auto checked = check_complete(outcome);
  EXPECT_EQ(checked.error().code, ErrorCode::interrupted);
  EXPECT_EQ(checked.error().message,
            "interrupted: the excitation is off; 1 of 3 steps were measured and kept");
}

TEST(ShowOutcome, AnOutputThatMayBeOnIsWhatTheLastLineEndsWith) {
  RunOutcome outcome = outcome_of_steps(3, 1);
  outcome.output_may_be_on = true;
  outcome.output_is_guarded = true;
  outcome.problem = "the instrument does not answer";
  const std::string by_guard =
      "1 of 3 steps were measured and kept; THE OUTPUT OF THE GENERATOR MAY BE ON: it has not "
      "confirmed that it is off; switch it off by hand. A guard goes on trying for ten minutes";
  EXPECT_EQ(check_complete(outcome).error().code, ErrorCode::device);
  EXPECT_EQ(check_complete(outcome).error().message, "the instrument does not answer; " + by_guard);
  outcome.interrupted = true;
  EXPECT_EQ(check_complete(outcome).error().code, ErrorCode::device);
  EXPECT_EQ(check_complete(outcome).error().message, "interrupted; " + by_guard);
}

TEST(ShowOutcome, OfAGeneratorThatAPersonSetsNoGuardIsPromised) {
  RunOutcome outcome = outcome_of_steps(3, 1);
  outcome.output_may_be_on = true;
  const std::string by_hand = "THE OUTPUT OF THE GENERATOR MAY BE ON: nobody has confirmed that it "
                              "is off; switch it off at the generator";
  outcome.problem = "ended by a command of 'ada@desk'";
  EXPECT_EQ(check_complete(outcome).error().message,
            outcome.problem + "; 1 of 3 steps were measured and kept; " + by_hand);
  outcome.interrupted = true;
  EXPECT_EQ(check_complete(outcome).error().message,
            "interrupted; 1 of 3 steps were measured and kept; " + by_hand);
}

// As a calibration says it, of which nothing is kept.
TEST(ShowOutcome, TheEndOfARunSaysWhatHasBecomeOfIt) {
  RunOutcome outcome = outcome_of_steps(3, 3);
  EXPECT_TRUE(check_end(outcome, "no file was written"));
  outcome.problem = "the shaker stopped";
  EXPECT_EQ(check_end(outcome, "no file was written").error().message,
            "the shaker stopped; no file was written");
  outcome.interrupted = true;
  EXPECT_EQ(check_end(outcome, "no file was written").error().message,
            "interrupted: the excitation is off; no file was written");
  outcome.output_may_be_on = true;
  EXPECT_THAT(check_end(outcome, "no file was written").error().message,
              testing::StartsWith("interrupted; no file was written; THE OUTPUT"));
}

TEST(ShowOutcome, WhatEndedARunEarlyComesFirst) {
  RunOutcome outcome = outcome_of_steps(3, 1);
  outcome.problem = "the shaker stopped";
  EXPECT_THAT(check_complete(outcome).error().message, HasSubstr("the shaker stopped; 1 of 3"));
}

} // namespace
} // namespace dyncal::inline views
