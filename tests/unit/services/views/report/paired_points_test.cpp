#include "services/views/report/paired_points.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

ResultPoints points_at(const std::vector<double>& levels_m_s2, const std::string& axis = "",
                       const std::string& channel = "dau/x") {
  ResultPoints points;
  for (const double level : levels_m_s2) {
    points.emplace(
        PointIdentity{.channel = channel, .frequency_hz = 80.0, .level_m_s2 = level, .axis = axis},
        ResultPoint{R"(\one)", {level, {.u = 0.01}, 0.0, {.u = 0.01}}});
  }
  return points;
}

TEST(PairedPoints, PairsEveryLevelWithItsOwn) {
  const PairedPoints paired = pair_points(points_at({2, 4, 8, 12, 15}), points_at({10, 8, 2}), {});
  ASSERT_EQ(paired.pairs.size(), 2U);
  for (const PointPair& pair : paired.pairs) {
    EXPECT_EQ(pair.first_identity, pair.second_identity);
    EXPECT_EQ(pair.first.value.magnitude, pair.second.value.magnitude);
  }
  ASSERT_EQ(paired.only_first.size(), 3U);
  EXPECT_EQ(paired.only_first[2].level_m_s2, 15.0);
  ASSERT_EQ(paired.only_second.size(), 1U);
  EXPECT_EQ(paired.only_second[0].level_m_s2, 10.0);
  EXPECT_EQ(first_levels_m_s2(paired), (std::vector<double>{2, 4, 8, 12, 15}));
  EXPECT_EQ(second_levels_m_s2(paired), (std::vector<double>{2, 8, 10}));
}

TEST(PairedPoints, PairsLevelsAndChannelsThatAreChosen) {
  ResultPoints second = points_at({10}, "", "dau/y");
  second.merge(points_at({10}));
  const PairedPoints paired = pair_points(points_at({2, 4}), second,
                                          {.first_channel = "dau/x",
                                           .second_channel = "dau/y",
                                           .first_level_m_s2 = 2,
                                           .second_level_m_s2 = 10});
  ASSERT_EQ(paired.pairs.size(), 1U);
  EXPECT_EQ(paired.pairs[0].second_identity.channel, "dau/y");
  EXPECT_EQ(paired.pairs[0].first.value.magnitude, 2.0);
  EXPECT_EQ(paired.pairs[0].second.value.magnitude, 10.0);
  EXPECT_TRUE(paired.only_first.empty() && paired.only_second.empty());
}

TEST(PairedPoints, DoNotPairTwoAxes) {
  const PairedPoints paired = pair_points(points_at({10}, "x"), points_at({10}, "z"), {});
  EXPECT_TRUE(paired.pairs.empty());
  EXPECT_EQ(paired.only_first.size(), 1U);
  EXPECT_EQ(paired.only_second.size(), 1U);
  EXPECT_EQ(paired.assumed_axis, "");
}

TEST(PairedPoints, TakeTheOnlyAxisWhereOneResultStatesNone) {
  for (const bool first : {true, false}) {
    const PairedPoints paired =
        pair_points(points_at({10}, first ? "" : "z"), points_at({10}, first ? "z" : ""), {});
    ASSERT_EQ(paired.pairs.size(), 1U);
    EXPECT_EQ(paired.assumed_axis, "z");
  }
  ResultPoints both = points_at({10}, "x");
  both.merge(points_at({10}, "z"));
  EXPECT_TRUE(pair_points(points_at({10}), both, {}).pairs.empty());
}

TEST(PairedPoints, PairRepetitionsAndPointsThatAPlanHasTwice) {
  ResultPoints first = points_at({10, 10});
  ResultPoints second = points_at({10, 10, 10});
  const PairedPoints paired = pair_points(first, second, {});
  EXPECT_EQ(paired.pairs.size(), 2U);
  EXPECT_EQ(paired.only_second.size(), 1U);
  PointIdentity repeated = first.begin()->first;
  repeated.repetition = 2;
  first.emplace(repeated, first.begin()->second);
  EXPECT_EQ(pair_points(first, second, {}).only_first.front().repetition, 2U);
}

} // namespace
} // namespace dyncal::inline views
