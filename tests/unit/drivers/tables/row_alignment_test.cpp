#include "drivers/tables/row_alignment.hpp"

#include <random>

#include <gtest/gtest.h>

namespace dyncal::drivers::tables {
namespace {

using Frequencies = std::vector<double>;

std::vector<std::optional<std::size_t>> rows_of(const Frequencies& steps, const Frequencies& rows) {
  std::vector<std::optional<std::size_t>> result;
  for (const StepRow& one : align_rows(steps, rows)) {
    result.push_back(one.row);
  }
  return result;
}

TEST(RowAlignment, JoinsByOrderAndFrequencyWithinOnePercent) {
  const Frequencies steps{10.0, 12.5, 16.0};
  const std::vector<std::optional<std::size_t>> all{0, 1, 2};
  EXPECT_EQ(rows_of(steps, {10.09, 12.4, 16.0}), all);
  const std::vector<std::optional<std::size_t>> two{0, std::nullopt, 2};
  EXPECT_EQ(rows_of(steps, {10.0, 12.7, 16.0}), two); // 1.6 %
}

TEST(RowAlignment, LeavesTestTonesAndMissingRowsOut) {
  const Frequencies steps{10.0, 80.0, 250.0};
  const std::vector<std::optional<std::size_t>> behind{2, 3, 4};
  EXPECT_EQ(rows_of(steps, {80.0, 250.0, 10.0, 80.0, 250.0}), behind);
  const std::vector<std::optional<std::size_t>> without_first{std::nullopt, 0, 1};
  EXPECT_EQ(rows_of(steps, {80.0, 250.0}), without_first);
  EXPECT_TRUE(align_rows(steps, Frequencies{80.0, 250.0}).front().certain);
}

TEST(RowAlignment, GivesNoRowThatMayBeOfAnotherStep) {
  const auto twice = align_rows(Frequencies{160.0, 160.0, 250.0}, Frequencies{160.0, 250.0});
  EXPECT_FALSE(twice[0].certain);
  EXPECT_FALSE(twice[1].certain);
  EXPECT_FALSE(twice[0].row.has_value());
  EXPECT_EQ(twice[0].possible, std::vector<std::size_t>{0});
  EXPECT_EQ(twice[2].row, 1U);
  const auto extra = align_rows(Frequencies{160.0, 250.0}, Frequencies{160.0, 160.0, 250.0});
  EXPECT_FALSE(extra[0].certain);
  EXPECT_EQ(extra[0].possible, (std::vector<std::size_t>{0, 1}));
}

// Rows are lost, or put in, anywhere: whatever is certain is right.
TEST(RowAlignment, IsNeverWrongWhereItIsCertain) {
  std::mt19937 random(7);
  int certain = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Frequencies steps, rows;
    std::vector<std::optional<std::size_t>> truth;
    for (int i = 0; i < 8; ++i) {
      steps.push_back(10.0 * static_cast<double>(1 + random() % 4));
      truth.emplace_back();
      if (random() % 8 != 0) {
        truth.back() = rows.size();
        rows.push_back(steps.back());
      }
    }
    const auto aligned = align_rows(steps, rows); // lost alone: the longest way is the true one
    for (std::size_t i = 0; i < steps.size(); ++i) {
      if (aligned[i].certain) {
        ++certain;
        EXPECT_EQ(aligned[i].row, truth[i]);
      }
    }
  }
  EXPECT_GT(certain, 8000);
}

TEST(RowAlignment, OfNothingIsNothing) {
  EXPECT_TRUE(align_rows({}, Frequencies{10.0}).empty());
  const auto none = align_rows(Frequencies{10.0}, {});
  ASSERT_EQ(none.size(), 1U);
  EXPECT_TRUE(none.front().certain);
  EXPECT_FALSE(none.front().row.has_value());
}

} // namespace
} // namespace dyncal::drivers::tables
