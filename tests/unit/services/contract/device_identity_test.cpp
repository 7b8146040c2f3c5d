#include "services/contract/device_identity.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

TEST(DeviceIdentity, StandsInPlaceOfWhatTheInstrumentSays) {
  drivers::SourceDescription description;
  description.device = "card";
  description.serial = "17";
  const auto stated =
      with_identity(description, {.device = "", .serial = "PTB-4", .firmware = "2"});
  EXPECT_EQ(stated.device, "card");
  EXPECT_EQ(stated.serial, "PTB-4");
  EXPECT_EQ(stated.firmware, "2");
}

TEST(DeviceIdentity, StatesRangesOfChannels) {
  drivers::SourceDescription description;
  for (const char* name : {"x", "y", "z"}) {
    drivers::ChannelDescription& channel = description.channels.emplace_back();
    channel.name = name;
    channel.minimum = -3.0;
    channel.maximum = 3.0;
  }
  DeviceIdentity identity;
  identity.ranges = {{"x", {}}, {"y", {-20.0, 30.0}}};
  const auto stated = with_identity(description, identity);
  EXPECT_EQ(stated.channels[0].minimum, stated.channels[0].maximum);
  EXPECT_EQ(stated.channels[1].minimum, -20.0);
  EXPECT_EQ(stated.channels[1].maximum, 30.0);
  EXPECT_EQ(stated.channels[2].maximum, 3.0);
}

} // namespace
} // namespace dyncal::inline contract
