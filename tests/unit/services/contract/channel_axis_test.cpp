#include "services/contract/channel_axis.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

TEST(ChannelAxis, IsAtTheEndOfAName) {
  const std::vector<ChannelAxis> none;
  EXPECT_EQ(axis_of("dau/acceleration_x", none), "x");
  EXPECT_EQ(axis_of("sensor/AccelerationY", none), "y");
  EXPECT_EQ(axis_of("acs/z", none), "z");
  for (const char* const name : {"acs/reference", "dau/mux", "dau/MUX", "dau/Data_01", "x", ""}) {
    EXPECT_EQ(axis_of(name, none), "") << name;
  }
}

TEST(ChannelAxis, IsStatedOfOthers) {
  const std::vector<ChannelAxis> stated{{"dau/Data_03", "z"}, {"dau/acceleration_x", "y"}};
  EXPECT_EQ(axis_of("dau/Data_03", stated), "z");
  EXPECT_EQ(axis_of("dau/acceleration_x", stated), "y");
}

TEST(ChannelAxis, TellsWhatLiesAcross) {
  EXPECT_TRUE(lies_across("x", "z"));
  EXPECT_TRUE(lies_across("X", "-z"));
  EXPECT_FALSE(lies_across("z", "-z"));
  EXPECT_FALSE(lies_across("x", ""));
  EXPECT_FALSE(lies_across("", "z"));
  EXPECT_FALSE(lies_across("x", "vertical"));
}

} // namespace
} // namespace dyncal::inline contract
