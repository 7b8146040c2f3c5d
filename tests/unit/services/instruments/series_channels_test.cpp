#include "services/instruments/series_channels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline instruments {
namespace {

drivers::tss::Series series_of_two() {
  drivers::tss::Series series;
  series.samples = 3;
  series.channels.resize(2);
  series.channels[0].name = "CH1";
  series.channels[0].unit = "V";
  series.channels[1].name = "acceleration_z";
  series.values = {1, 2, 3, 10, 20, 30};
  return series;
}

TEST(SeriesChannels, AreSelectedByOurNamesInTheOrderOfTheBenchFile) {
  const auto selected =
      select_channels(series_of_two(), {{"CH1", "temperature"}}, {"acceleration_z", "temperature"});
  ASSERT_TRUE(selected.has_value()) << selected.error().message;
  EXPECT_EQ(selected->values, (std::vector<double>{10, 20, 30, 1, 2, 3}));
  EXPECT_EQ(selected->channels[0].name, "acceleration_z");
  EXPECT_EQ(selected->channels[1].unit, "V");
}

TEST(SeriesChannels, WhatNobodyCalibratesIsLeftOut) {
  const auto selected = select_channels(series_of_two(), {}, {"CH1"});
  ASSERT_TRUE(selected.has_value());
  EXPECT_EQ(selected->values, (std::vector<double>{1, 2, 3}));
}

TEST(SeriesChannels, AMissingChannelIsNamedWithThoseThereAre) {
  const auto selected = select_channels(series_of_two(), {}, {"acceleration_x"});
  ASSERT_FALSE(selected.has_value());
  EXPECT_THAT(selected.error().message,
              testing::HasSubstr("'acceleration_x'; it has: CH1, acceleration_z"));
}

} // namespace
} // namespace dyncal::inline instruments
