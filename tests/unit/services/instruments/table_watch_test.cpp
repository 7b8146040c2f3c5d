// Tables that are written while a run goes on: which row is handed out when, and which never.
#include "services/instruments/table_watch.hpp"

#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline instruments {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* head =
    "loop;frequency;ex_amp;ex_amp_std;phase;phase_std\n\n#Number;Hz;m/s^2;m/s^2;deg;deg\n";

std::string row(int loop, double frequency_hz, double amplitude) {
  return fmt::format("{};{};{};0.002;12.5;0.02\n", loop, frequency_hz, amplitude);
}

class TableWatchTest : public testing::Test {
protected:
  void write(const std::string& rows, const std::string& file = "table.csv") {
    folder_.write(file, head + rows);
  }
  void begin(const std::vector<std::string>& frequencies_hz, int repetitions = 1) {
    std::vector<PlannedReferenceStep> plan;
    for (int repetition = 1; repetition <= repetitions; ++repetition) {
      for (const std::string& text : frequencies_hz) {
        plan.push_back({static_cast<std::uint32_t>(plan.size() + 1),
                        static_cast<std::uint32_t>(repetition), text, 2.0});
      }
    }
    auto watch = TableWatch::begin(source_, std::move(plan), now_);
    ASSERT_TRUE(watch) << watch.error().message;
    watch_.emplace(*std::move(watch));
  }
  // What is handed out now: "step amplitude", or "step -" without a value.
  std::vector<std::string> look(bool run_is_over = false) {
    now_ += 1s;
    auto news = watch_->look(now_, run_is_over);
    if (!news) {
      return {news.error().message};
    }
    std::vector<std::string> texts;
    for (const ReferenceStep& step : news->steps) {
      texts.push_back(step.problem.empty() ? fmt::format("{} {}", step.step, step.amplitude_m_s2)
                                           : fmt::format("{} -", step.step));
      problem_ = step.problem.empty() ? problem_ : step.problem;
    }
    sentences_.insert(sentences_.end(), news->sentences.begin(), news->sentences.end());
    return texts;
  }

  tests::TemporaryFolder folder_;
  SourceSettings source_ = [this] {
    SourceSettings source;
    source.name = "acs";
    TableSourceSettings table;
    table.paths = {folder_.path() / "table.csv"};
    table.coverage = 2.0;
    source.driver = table;
    return source;
  }();
  TableWatch::Instant now_{1000s};
  std::optional<TableWatch> watch_;
  std::string problem_;
  std::vector<std::string> sentences_;
};

TEST_F(TableWatchTest, HandsARowOutWhenTheNextHasFollowedAndTheLastWhenTheRunIsOver) {
  begin({"20", "40", "80"});
  EXPECT_THAT(look(), IsEmpty());
  write(row(0, 20, 10.1));
  EXPECT_THAT(look(), IsEmpty());
  write(row(0, 20, 10.1) + row(0, 40, 10.2));
  EXPECT_THAT(look(), ElementsAre("1 10.1"));
  write(row(0, 20, 10.1) + row(0, 40, 10.2) + "0;80;10.");
  EXPECT_THAT(look(), IsEmpty()); // half a row
  write(row(0, 20, 10.1) + row(0, 40, 10.2) + row(0, 80, 10.3));
  EXPECT_THAT(look(), ElementsAre("2 10.2"));
  EXPECT_THAT(look(true), ElementsAre("3 10.3"));
  EXPECT_FALSE(watch_->is_finished(now_));
  now_ += 60s;
  EXPECT_THAT(look(true), IsEmpty());
  EXPECT_TRUE(watch_->is_finished(now_));
  EXPECT_THAT(sentences_, IsEmpty());
}

// Nobody says that a run without excitation of its own is over.
TEST_F(TableWatchTest, HandsTheLastRowOutWhenNothingChangesAnyMore) {
  begin({"20", "40"});
  write(row(0, 20, 10.1) + row(0, 40, 10.2));
  EXPECT_THAT(look(), ElementsAre("1 10.1"));
  now_ += 12s; // 10 s, and twice the step of 2 s
  EXPECT_THAT(look(), IsEmpty());
  now_ += 2s;
  EXPECT_THAT(look(), ElementsAre("2 10.2"));
}

TEST_F(TableWatchTest, PassesOverWhatStoodThereBefore) {
  const std::string old = row(0, 20, 9.1) + row(0, 40, 9.2);
  write(old);
  begin({"20", "40"});
  EXPECT_THAT(look(true), IsEmpty());
  write(old + row(0, 20, 10.1) + row(0, 40, 10.2)); // it grows
  EXPECT_THAT(look(true), ElementsAre("1 10.1", "2 10.2"));
  begin({"20", "40"});
  write(row(0, 20, 11.1)); // it is written anew
  EXPECT_THAT(look(), IsEmpty());
  write(row(0, 20, 11.1) + row(0, 40, 11.2));
  EXPECT_THAT(look(true), ElementsAre("1 11.1", "2 11.2"));
}

TEST_F(TableWatchTest, TakesNoTestToneForAStepThatIsYetToCome) {
  begin({"20", "40", "80"});
  write(row(0, 40, 1.0) + row(0, 80, 1.0));
  EXPECT_THAT(look(), IsEmpty());
  now_ += 100s; // a pause before the sweep
  EXPECT_THAT(look(), IsEmpty());
  write(row(0, 40, 1.0) + row(0, 80, 1.0) + row(0, 20, 10.1));
  EXPECT_THAT(look(), IsEmpty());
  write(row(0, 40, 1.0) + row(0, 80, 1.0) + row(0, 20, 10.1) + row(0, 40, 10.2) + row(0, 80, 10.3));
  EXPECT_THAT(look(), ElementsAre("1 10.1", "2 10.2"));
  EXPECT_THAT(look(true), ElementsAre("3 10.3"));
  now_ += 60s;
  EXPECT_THAT(look(true), IsEmpty());
  EXPECT_THAT(sentences_, ElementsAre(HasSubstr("line 4 (40 Hz), ")));
}

TEST_F(TableWatchTest, SaysOfARowThatWasMeasuredTwiceThatTheOrderDoesNotTell) {
  begin({"20", "40", "80"});
  write(row(0, 20, 10.1) + row(0, 40, 10.2) + row(0, 40, 10.25) + row(0, 80, 10.3));
  EXPECT_THAT(look(), ElementsAre("1 10.1"));
  EXPECT_THAT(look(true), IsEmpty());
  now_ += 60s;
  EXPECT_THAT(look(true), ElementsAre("2 -", "3 10.3"));
  EXPECT_THAT(problem_, HasSubstr("the order does not tell"));
}

TEST_F(TableWatchTest, TakesBackARowThatTheTableNoLongerBearsOut) {
  begin({"20", "40", "80"});
  write(row(0, 20, 10.1) + row(0, 40, 10.2) + row(0, 80, 10.3));
  EXPECT_THAT(look(), ElementsAre("1 10.1", "2 10.2"));
  write(row(0, 20, 10.1) + row(0, 40, 10.9) + row(0, 80, 10.3)); // another value
  EXPECT_THAT(look(), ElementsAre("2 -"));
  EXPECT_THAT(sentences_, ElementsAre(HasSubstr("the row of step 2 (40 Hz) was handed out")));
  EXPECT_THAT(look(), IsEmpty()); // said once
}

TEST_F(TableWatchTest, SaysOfStepsWithoutARowThatTheyHaveNoneAndNamesRowsOfNoStep) {
  begin({"20", "40", "80"});
  write(row(0, 20, 10.1) + row(0, 55, 1.0) + row(0, 80, 10.3));
  EXPECT_THAT(look(), ElementsAre("1 10.1"));
  EXPECT_THAT(look(true), IsEmpty()); // the row of 40 Hz may be late
  now_ += 60s;
  EXPECT_THAT(look(true), ElementsAre("2 -", "3 10.3"));
  EXPECT_THAT(problem_, HasSubstr("no row for this step, of 40 Hz"));
  EXPECT_THAT(sentences_, ElementsAre(HasSubstr("line 5 (55 Hz)")));
}

TEST_F(TableWatchTest, ReadsAFileARepetitionOfAFolderOrAList) {
  auto& table = std::get<TableSourceSettings>(source_.driver);
  table.paths = {folder_.path()};
  write(row(0, 20, 9.1), "a-old.csv");
  begin({"20"}, 2);
  write(row(0, 20, 10.1), "b.csv");
  EXPECT_THAT(look(), IsEmpty());
  write(row(1, 20, 10.2), "c.csv");
  EXPECT_THAT(look(), ElementsAre("1 10.1"));
  EXPECT_THAT(look(true), ElementsAre("2 10.2"));

  table.paths = {folder_.path() / "first.csv", folder_.path() / "second.csv"};
  begin({"20"}, 2);
  write(row(0, 20, 10.4), "second.csv"); // the first repetition has none
  EXPECT_THAT(look(true), ElementsAre("2 10.4"));
  now_ += 60s;
  EXPECT_THAT(look(true), ElementsAre("1 -"));
}

TEST_F(TableWatchTest, FailsWithFileAndPlaceUntilTheTableIsRight) {
  begin({"20", "40"});
  write("0;20;ten;0.002;12.5;0.02\n");
  EXPECT_THAT(look(), ElementsAre(HasSubstr("table.csv: line 4")));
  write(row(0, 20, 10.1) + row(0, 40, 10.2));
  EXPECT_THAT(look(), ElementsAre("1 10.1"));
}

// However the writing is cut into looks, steps get their own rows.
TEST_F(TableWatchTest, GivesEveryStepItsOwnRowHoweverTheTableGrows) {
  constexpr unsigned seed = 20261129;
  std::mt19937 random(seed);
  const std::vector<std::string> frequencies{"10", "12.5", "16", "20", "25", "31.5", "40"};
  for (int run = 0; run < 20; ++run) {
    write("");
    begin(frequencies, 2);
    std::string rows;
    std::vector<std::string> wanted;
    for (std::size_t i = 0; i < 2 * frequencies.size(); ++i) {
      const double amplitude = 1.0 + static_cast<double>(run * 100 + static_cast<int>(i));
      rows += row(i < frequencies.size() ? 0 : 1, std::stod(frequencies[i % frequencies.size()]),
                  amplitude);
      wanted.push_back(fmt::format("{} {}", i + 1, amplitude));
    }
    std::vector<std::string> got;
    for (std::size_t end = 0; end < rows.size();) {
      end = std::min(rows.size(), end + 1 + random() % 90);
      write(rows.substr(0, end));
      for (std::string& one : look()) {
        got.push_back(std::move(one));
      }
    }
    for (std::string& one : look(true)) {
      got.push_back(std::move(one));
    }
    EXPECT_EQ(got, wanted) << "run " << run << " of seed " << seed;
  }
}

} // namespace
} // namespace dyncal::inline instruments
