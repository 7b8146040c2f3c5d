#include "services/views/figures/axis.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline views::figures {
namespace {

using testing::ElementsAre;

Range range(Scale scale, double low, double high) {
  Range result(scale);
  result.include(low);
  result.include(high);
  return result;
}

std::vector<std::string> labels(const Axis& axis) {
  std::vector<std::string> result;
  for (const auto& tick : axis.ticks) {
    if (!tick.label.empty()) {
      result.push_back(tick.label);
    }
  }
  return result;
}

TEST(LinearAxis, HasTicksAtMultiplesOfOneTwoOrFive) {
  EXPECT_THAT(labels(make_axis(range(Scale::linear, -0.04, 1.04), 6)),
              ElementsAre("0.0", "0.2", "0.4", "0.6", "0.8", "1.0"));
  EXPECT_THAT(labels(make_axis(range(Scale::linear, -10.5, 0.5), 5)),
              ElementsAre("−10", "−5", "0"));
}

TEST(LinearAxis, KeepsTheDecimalsThatTellTicksApartOnALargeOffset) {
  EXPECT_THAT(labels(make_axis(range(Scale::linear, 996.89, 997.01), 4)),
              ElementsAre("996.90", "996.95", "997.00"));
}

TEST(LinearAxis, TakesOutACommonPowerOfTenWhenNumbersAreVerySmallOrLarge) {
  const auto small = make_axis(range(Scale::linear, 0, 3e-5), 3);
  EXPECT_EQ(small.factor, "×10⁻⁵");
  EXPECT_THAT(labels(small), ElementsAre("0", "1", "2", "3"));
  EXPECT_EQ(make_axis(range(Scale::linear, 0, 4e6), 4).factor, "×10⁶");
}

TEST(LinearAxis, GivesARangeOfOneValueSomeWidth) {
  Range range;
  range.include(0.0);
  EXPECT_GE(make_axis(range, 5).ticks.size(), 2U);
  EXPECT_LT(make_axis(range, 5).low, make_axis(range, 5).high);
}

TEST(LogarithmicAxis, LabelsOneTwoAndFiveOfAShortRange) {
  const auto axis = make_axis(range(Scale::logarithmic, 9, 270), 10);
  EXPECT_THAT(labels(axis), ElementsAre("10", "20", "50", "100", "200"));
  EXPECT_GT(axis.ticks.size(), 5U) << "the other mantissas are minor ticks";
}

TEST(LogarithmicAxis, LabelsPowersOfTenOfALongRange) {
  EXPECT_THAT(labels(make_axis(range(Scale::logarithmic, 0.6, 2e6), 8)),
              ElementsAre("10⁰", "10¹", "10²", "10³", "10⁴", "10⁵", "10⁶"));
}

TEST(LogarithmicAxis, SkipsPowersWhereThereIsNoRoom) {
  EXPECT_LE(labels(make_axis(range(Scale::logarithmic, 1e-9, 1e9), 6)).size(), 7U);
}

TEST(LogarithmicAxis, FallsBackToEvenTicksInLessThanHalfADecade) {
  EXPECT_THAT(labels(make_axis(range(Scale::logarithmic, 78, 122), 5)),
              ElementsAre("80", "90", "100", "110", "120"));
}

TEST(LogarithmicAxis, LabelsGivenTicksAsFarAsThereIsRoom) {
  const std::vector<double> thirds{10, 12.5, 16, 20, 25, 31.5, 40, 50, 63, 80, 100, 500};
  const auto wide = make_axis(range(Scale::logarithmic, 9, 110), thirds, 0.012);
  EXPECT_EQ(wide.ticks.size(), 11U); // 500 is not in the range
  EXPECT_THAT(labels(wide),
              ElementsAre("10", "12.5", "16", "20", "25", "31.5", "40", "50", "63", "80", "100"));
  const auto narrow = make_axis(range(Scale::logarithmic, 9, 110), thirds, 0.04);
  EXPECT_EQ(narrow.ticks.size(), 11U);
  EXPECT_THAT(labels(narrow), ElementsAre("10", "16", "25", "40", "63", "100"));
}

TEST(LogarithmicAxis, PutsTheGeometricMeanInTheMiddle) {
  EXPECT_NEAR(make_axis(range(Scale::logarithmic, 1, 100), 3).position(10), 0.5, 1e-12);
}

TEST(RangeOfAnAxis, IgnoresWhatCannotBeShown) {
  Range linear;
  linear.include(std::numeric_limits<double>::quiet_NaN());
  linear.include(std::numeric_limits<double>::infinity());
  EXPECT_TRUE(linear.empty());
  Range logarithmic(Scale::logarithmic);
  logarithmic.include(0);
  logarithmic.include(-3);
  EXPECT_TRUE(logarithmic.empty());
}

TEST(RangeOfAnAxis, HasSomeWidthAfterPaddingWhateverWentIn) {
  for (const Scale scale : {Scale::linear, Scale::logarithmic}) {
    for (const double value : {0.0, 1e-300, 1.0, 996.96, 1e300}) {
      const auto padded = range(scale, value, value).padded(0.05);
      EXPECT_GT(padded.high(), padded.low()) << value;
      EXPECT_FALSE(labels(make_axis(padded, 5)).empty()) << value;
    }
    EXPECT_GT(Range(scale).padded(0.05).high(), Range(scale).padded(0.05).low());
  }
}

TEST(RangeOfAnAxis, YieldsAFewTicksForAnyWidth) {
  for (int exponent = -12; exponent <= 12; ++exponent) {
    for (const double mantissa : {1.0, 1.9, 2.1, 4.9, 5.1, 9.9}) {
      const auto count =
          labels(make_axis(range(Scale::linear, 0, mantissa * std::pow(10.0, exponent)), 6)).size();
      EXPECT_GE(count, 3U) << mantissa << "e" << exponent;
      EXPECT_LE(count, 8U) << mantissa << "e" << exponent;
    }
  }
}

} // namespace
} // namespace dyncal::inline views::figures
