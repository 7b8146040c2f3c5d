#include "drivers/tables/table_match.hpp"

#include <gtest/gtest.h>

namespace dyncal::drivers::tables {
namespace {

const std::vector<double> frequencies_hz{10.0, 80.0, 250.0};

std::vector<PlannedRow> plan_of(std::uint32_t repetitions) {
  std::vector<PlannedRow> plan;
  for (std::uint32_t repetition = 1; repetition <= repetitions; ++repetition) {
    for (const double f : frequencies_hz) {
      plan.push_back({repetition, f});
    }
  }
  return plan;
}

// Lines from 4 on.
TableFile file_of(const std::vector<std::pair<std::int64_t, double>>& rows) {
  TableFile file{.name = "t.csv", .rows = {}};
  for (const auto& [loop, f] : rows) {
    file.rows.push_back(
        {.line = file.rows.size() + 4, .loop = loop, .frequency_hz = f, .amplitude_m_s2 = 1.0});
  }
  return file;
}

std::vector<std::size_t> lines_of(const TableMatch& match) {
  std::vector<std::size_t> lines;
  for (const MatchedRow& one : match.steps) {
    lines.push_back(one.at.row == nullptr ? 0 : one.at.row->line);
  }
  return lines;
}

TEST(TableMatch, TakesTestTonesAndRepeatedRowsOut) {
  const TableFile file = file_of({{0, 80},
                                  {0, 250},
                                  {0, 10},
                                  {0, 80},
                                  {0, 250},
                                  {0, 250},
                                  {1, 80},
                                  {1, 250},
                                  {1, 10},
                                  {1, 80},
                                  {1, 250},
                                  {1, 250}});
  TableSettings settings{.paths = {}, .skip_first_rows = 2, .skip_last_rows = 1};
  const auto match = match_table({&file, 1}, plan_of(2), settings);
  ASSERT_TRUE(match.has_value()) << match.error().message;
  EXPECT_EQ(lines_of(*match), (std::vector<std::size_t>{6, 7, 8, 12, 13, 14}));
  EXPECT_TRUE(match->extra.empty());
  settings.skip_first_rows = 0;
  settings.skip_last_rows = 0;
  const auto without = match_table({&file, 1}, plan_of(2), settings);
  ASSERT_TRUE(without.has_value());
  EXPECT_EQ(lines_of(*without), (std::vector<std::size_t>{6, 7, 0, 12, 13, 0}));
  EXPECT_EQ(without->steps[2].problem,
            "the order does not tell which row of the reference's table is of this step: t.csv: "
            "line 8 (250 Hz) or t.csv: line 9 (250 Hz); name rows that are no steps with the "
            "source's keys 'skip_first_rows' and 'skip_last_rows'");
  EXPECT_EQ(without->extra.size(), 8U);
  EXPECT_EQ(without->extra.front(), "t.csv: line 4 (80 Hz)");
}

TEST(TableMatch, NeverGivesAStepTheRowOfAnotherRepetition) {
  const TableFile file = file_of({{0, 10}, {0, 80}, {1, 10}, {1, 80}, {1, 250}});
  const auto match = match_table({&file, 1}, plan_of(2), {.paths = {}});
  ASSERT_TRUE(match.has_value());
  EXPECT_EQ(lines_of(*match), (std::vector<std::size_t>{4, 5, 0, 6, 7, 8}));
  EXPECT_EQ(match->steps[2].problem,
            "the reference's table has no row for this step, of 250 Hz within 1 %");
}

TEST(TableMatch, TakesAFileForEachLoop) {
  TableFile one = file_of({{0, 10}, {0, 80}, {0, 250}}), two = one;
  two.name = "u.csv";
  for (ReferenceTableRow& row : two.rows) {
    row.loop.reset();
  }
  const TableFile files[] = {one, two};
  const auto match = match_table(files, plan_of(2), {.paths = {}});
  ASSERT_TRUE(match.has_value());
  EXPECT_EQ(lines_of(*match), (std::vector<std::size_t>{4, 5, 6, 4, 5, 6}));
  EXPECT_EQ(match->steps[3].at.file->name, "u.csv");
}

TEST(TableMatch, RefusesLoopsThatAreNoneOfThePlan) {
  const TableFile from_one = file_of({{1, 10}, {1, 80}, {1, 250}});
  const auto unknown = match_table({&from_one, 1}, plan_of(1), {.paths = {}});
  ASSERT_FALSE(unknown.has_value());
  EXPECT_EQ(unknown.error().message,
            "t.csv: line 4: the row is of loop 1, and loop 0 is taken for the first repetition; "
            "name the loop of the first repetition with the source's key 'first_loop'");
  const TableSettings named{.paths = {}, .first_loop = 1};
  const auto match = match_table({&from_one, 1}, plan_of(1), named);
  ASSERT_TRUE(match.has_value());
  EXPECT_EQ(lines_of(*match), (std::vector<std::size_t>{4, 5, 6}));
  const TableFile three = file_of({{0, 10}, {1, 10}, {2, 10}});
  const auto many = match_table({&three, 1}, plan_of(2), {.paths = {}});
  ASSERT_FALSE(many.has_value());
  EXPECT_EQ(many.error().message,
            "t.csv: line 6 (10 Hz): the table has 3 loops, and the plan 2 repetitions; the keys "
            "'first_loop' of the source and 'repetitions' of the excitation must agree with it");
  const TableFile mixed = file_of({{0, 10}, {1, 10}, {0, 80}});
  EXPECT_FALSE(match_table({&mixed, 1}, plan_of(2), {.paths = {}}).has_value());
}

} // namespace
} // namespace dyncal::drivers::tables
