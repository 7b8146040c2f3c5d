#include "services/evaluation/result/point_identity.hpp"

#include <set>

#include <gtest/gtest.h>

#include "services/evaluation/result/delay_points.hpp"

namespace dyncal::inline evaluation {
namespace {

StepResult result() {
  StepResult result;
  result.channel = "dau/x";
  result.frequency_hz = 80.0;
  result.level_m_s2 = 2.5;
  result.excited_axis = "z";
  result.repetition = 2;
  result.attempt = 3;
  return result;
}

TEST(PointIdentity, EveryPartTellsPointsApart) {
  StepResult other = result();
  std::set<PointIdentity> points{identity_of(other)};
  points.insert(identity_of(other)); // the same
  other.channel = "dau/y";
  points.insert(identity_of(other));
  other.frequency_hz = 40.0;
  points.insert(identity_of(other));
  other.level_m_s2 = 10.0;
  points.insert(identity_of(other));
  other.excited_axis = "y";
  points.insert(identity_of(other));
  other.repetition = 1;
  points.insert(identity_of(other));
  other.attempt = 1;
  points.insert(identity_of(other));
  EXPECT_EQ(points.size(), 7U);
  EXPECT_EQ(points.begin()->channel, "dau/x");
}

TEST(PointIdentity, OfAMeanIsWithoutRepetitionAndAttempt) {
  TransferFunction function;
  function.channel = "dau/x";
  function.excited_axis = "z";
  FrequencyPoint point;
  point.frequency_hz = 80.0;
  point.level_m_s2 = 2.5;
  EXPECT_EQ(identity_of(function, point), mean_identity_of(result()));
  EXPECT_NE(identity_of(function, point), identity_of(result()));
}

TEST(PointIdentity, IsNamedByWhatIsKnownAndToBeShown) {
  EXPECT_EQ(to_string(identity_of(result())),
            "dau/x at 80 Hz, 2.5 m/s^2, axis z, repetition 2, attempt 3");
  EXPECT_EQ(place_text(mean_identity_of(result()), {.levels = false, .axes = false}), "80 Hz");
  EXPECT_EQ(place_text({.frequency_hz = 12.5, .repetition = 1, .attempt = 1}),
            "12.5 Hz, repetition 1");
}

TEST(PointIdentity, SaysWhatTellsPointsApart) {
  PointIdentity point = mean_identity_of(result());
  PointIdentity other = point;
  other.frequency_hz = 10.0;
  EXPECT_FALSE(differences_of({point, other}).levels);
  EXPECT_FALSE(differences_of({}).axes);
  other.level_m_s2 = 10.0;
  EXPECT_TRUE(differences_of({point, other}).levels);
  EXPECT_FALSE(differences_of({point, other}).axes);
  other.axis = "";
  EXPECT_TRUE(differences_of({point, other}).axes);
}

FrequencyPoint point_at(double frequency_hz, double level_m_s2) {
  FrequencyPoint point;
  point.frequency_hz = frequency_hz;
  point.level_m_s2 = level_m_s2;
  return point;
}

TEST(DelayPoints, AreOfTheLevelThatMostFrequenciesHave) {
  const std::vector<FrequencyPoint> points{point_at(20, 10), point_at(80, 2),  point_at(80, 10),
                                           point_at(80, 15), point_at(125, 5), point_at(200, 10)};
  EXPECT_EQ(delay_points(points), (std::vector<std::size_t>{0, 2, 4, 5}));
  EXPECT_EQ(delay_levels_m_s2(points), (std::set<double>{5, 10}));
}

TEST(DelayPoints, AreAllOfOneLevelAFrequency) {
  const std::vector<FrequencyPoint> points{point_at(20, 1), point_at(80, 10)};
  EXPECT_EQ(delay_points(points), (std::vector<std::size_t>{0, 1}));
  EXPECT_TRUE(delay_levels_m_s2(points).empty());
}

TEST(DelayPoints, AreOfTheHighestOfLevelsThatAreAlikeOtherwise) {
  const std::vector<FrequencyPoint> points{point_at(20, 1), point_at(20, 10), point_at(80, 1),
                                           point_at(80, 10)};
  EXPECT_EQ(delay_points(points), (std::vector<std::size_t>{1, 3}));
}

} // namespace
} // namespace dyncal::inline evaluation
