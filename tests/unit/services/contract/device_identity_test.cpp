#include "services/contract/device_identity.hpp"

#include <gtest/gtest.h>

namespace dyncal::services {
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
  description.channels = {{.name = "x", .minimum = -1.0, .maximum = 1.0},
                          {.name = "y", .minimum = -2.0, .maximum = 2.0},
                          {.name = "z", .minimum = -3.0, .maximum = 3.0}};
  DeviceIdentity identity;
  identity.ranges = {{"x", {}}, {"y", {-20.0, 30.0}}};
  const auto stated = with_identity(description, identity);
  EXPECT_EQ(stated.channels[0].minimum, stated.channels[0].maximum);
  EXPECT_EQ(stated.channels[1].minimum, -20.0);
  EXPECT_EQ(stated.channels[1].maximum, 30.0);
  EXPECT_EQ(stated.channels[2].maximum, 3.0);
}

} // namespace
} // namespace dyncal::services
