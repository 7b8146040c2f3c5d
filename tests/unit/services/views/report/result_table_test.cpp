#include "services/views/report/result_table.hpp"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/views/report/expanded_uncertainty.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline views {
namespace {

using testing::HasSubstr;
using testing::Not;
using tests::example_outcome;

TEST(ResultTable, ShowsChannelsThatRespondAndNamesTheOthers) {
  const std::string table = result_table(example_outcome());
  EXPECT_THAT(table, HasSubstr("dau/acceleration_z\n"));
  EXPECT_THAT(
      table, HasSubstr("No response above three times its uncertainty in: dau/angular_velocity_x"));
}

TEST(ResultTable, DigitsFollowTheUncertainty) {
  const std::string table = result_table(example_outcome());
  EXPECT_THAT(table, HasSubstr("1.0000  0.0010      -0.5000   0.0020"));
  EXPECT_THAT(table, HasSubstr("group delay 8.1000 ms, u = 0.0010 ms"));
  EXPECT_THAT(table, HasSubstr("intercept -3.14159 rad, u = 0.00087 rad"));
}

TEST(ResultTable, TellsWhenTwiceUIsNotEnough) {
  RunOutcome outcome = example_outcome();
  EXPECT_THAT(result_table(outcome), Not(HasSubstr("U = k u")));
  analysis::RepetitionMean& mean = outcome.transfer_functions.front().points.front().mean;
  mean.u_magnitude = 3e-3; // U / 2
  mean.magnitude_rel.k = 4.0;
  EXPECT_THAT(result_table(outcome), HasSubstr("1.0000  0.0015 "));
  EXPECT_THAT(result_table(outcome), HasSubstr("k up to 4.00 (|H|) and 2.00 (arg H)"));
  EXPECT_THAT(result_table(outcome), HasSubstr(advice_on_repetitions(4.0)));
}

// Of 100 kB each, with lines of its own and what steers a terminal.
TEST(ResultTable, ShowsTextsOfOthersInItsOwnLinesOnly) {
  const std::string sound = result_table(example_outcome());
  std::string hostile;
  while (hostile.size() < 100'000) {
    hostile += "\x1b[2J\r\nok";
  }
  RunOutcome outcome = example_outcome();
  for (StepResult& result : outcome.results) {
    result.problem += hostile;
    for (Flag& flag : result.flags) {
      flag.sentence += hostile;
    }
  }
  for (TransferFunction& function : outcome.transfer_functions) {
    function.unit += hostile;
  }
  for (ClockReport& report : outcome.clock_reports) {
    report.source += hostile;
  }
  outcome.bench += hostile;
  outcome.pauses.push_back({0, 1, hostile});
  const std::string table = result_table(outcome);
  EXPECT_LT(table.size(), sound.size() + 10'000);
  EXPECT_EQ(table.find_first_of("\x1b\r"), std::string::npos);
  EXPECT_EQ(table.find("\nok"), std::string::npos);
  EXPECT_THAT(table, HasSubstr("[...]"));
}

TEST(ResultTable, HasAColumnOfLevelsWhereThereAreSeveral) {
  RunOutcome outcome = example_outcome();
  EXPECT_THAT(result_table(outcome), Not(HasSubstr("level / (m/s^2)")));
  TransferFunction& function = outcome.transfer_functions.front();
  function.points.push_back(function.points.back());
  function.points.back().level_m_s2 = 10.0;
  function.excited_axis = "z";
  const std::string table = result_table(outcome);
  EXPECT_THAT(table, HasSubstr("dau/acceleration_z, excited axis z\n"));
  EXPECT_THAT(table, HasSubstr("  f / Hz  level / (m/s^2)     |H|"));
  EXPECT_THAT(table, HasSubstr("      20             2.75  1.0000"));
  EXPECT_THAT(table, HasSubstr("      20               10  1.0000"));
  EXPECT_THAT(table, HasSubstr("rad (of the values at 2.75 m/s^2)\n"));
}

TEST(ResultTable, ShowsSmallMagnitudes) {
  RunOutcome outcome = example_outcome();
  for (FrequencyPoint& point : outcome.transfer_functions.front().points) {
    point.mean.magnitude = 1.0168e-8;
    point.mean.u_magnitude = 1.3e-11;
  }
  EXPECT_THAT(result_table(outcome), HasSubstr("1.0168e-08  1.3e-11"));
}

TEST(ResultTable, ShowsFlagsAndWhatTheyMean) {
  const std::string table = result_table(example_outcome());
  EXPECT_THAT(table, HasSubstr("3  samples_lost\n"));
  EXPECT_THAT(table, HasSubstr("  flags: polarity_inverted\n"));
  EXPECT_THAT(table, HasSubstr("\nFlags:\n  samples_lost (dau: samples lost): samples of"));
  EXPECT_THAT(table, HasSubstr("\n  polarity_inverted (polarity inverted): "));
}

TEST(ResultTable, LegendFitsATerminal) {
  const std::string table = result_table(example_outcome());
  std::istringstream lines(table.substr(table.find("\nFlags:")));
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    EXPECT_LE(line.size(), 100U) << line;
  }
  EXPECT_GE(count, 6U); // two flags, in more than a line each
}

TEST(ResultTable, HasNoLegendWithoutFlags) {
  RunOutcome outcome = example_outcome();
  outcome.results.front().flags.clear();
  outcome.transfer_functions.front().flags.clear();
  EXPECT_THAT(result_table(outcome), Not(HasSubstr("lags")));
}

TEST(ResultTable, TellsThatAUnitIsNotKnown) {
  RunOutcome outcome = example_outcome();
  outcome.transfer_functions.front().unit.clear();
  EXPECT_THAT(result_table(outcome),
              HasSubstr("dau/acceleration_z, unit not known: state the units"));
}

TEST(ResultTable, TellsWhatWasExcitedAgainAndWhenTheRunPaused) {
  const std::string table = result_table(tests::example_outcome());
  EXPECT_THAT(table, HasSubstr("\nExcited again: step 2 (attempt 3)\n"));
  EXPECT_THAT(table, HasSubstr("\nPaused:\n  42 s: paused by 'ada'\n"));
}

TEST(ResultTable, ListsWhatHasNoResultAndWhy) {
  EXPECT_THAT(result_table(example_outcome()), HasSubstr("step 2, 20 Hz: no steady sine"));
  EXPECT_THAT(result_table(example_outcome()), Not(HasSubstr("nan")));
}

} // namespace
} // namespace dyncal::inline views
