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

} // namespace
} // namespace dyncal::services
