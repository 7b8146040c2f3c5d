#include "services/contract/source_description.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

drivers::SourceDescription instrument(const std::string& device, const std::string& serial) {
  drivers::SourceDescription description;
  description.device = device;
  description.serial = serial;
  return description;
}

TEST(SourceDescription, NamesBothInstrumentsWhereTheyAreNotTheSame) {
  const auto first = instrument("MPU-9250", "0xbccb0100");
  EXPECT_EQ(device_difference("dau", first, instrument("MPU-9250", "0xbccb0200")),
            "source 'dau' is another instrument than the run began with: now MPU-9250, serial "
            "number 0xbccb0200, then MPU-9250, serial number 0xbccb0100; put that one back, or "
            "begin a new run");
  EXPECT_NE(device_difference("dau", first, instrument("BMA280", "0xbccb0100")), "");
  EXPECT_NE(device_difference("dau", first, instrument("MPU-9250", "\x1b[2J\n")).find("?[2J?"),
            std::string::npos); // what it says of itself steers no terminal
}

TEST(SourceDescription, TakesWhatIsNotKnownForNoDifference) {
  const auto first = instrument("MPU-9250", "0xbccb0100");
  EXPECT_EQ(device_difference("dau", first, first), "");
  EXPECT_EQ(device_difference("dau", first, instrument("", "0xbccb0100")), "");
  EXPECT_EQ(device_difference("dau", first, instrument("MPU-9250", "")), "");
  EXPECT_EQ(device_difference("dau", instrument("", ""), first), "");
  auto renewed = first;
  renewed.firmware = "2";
  renewed.nominal_rate_hz = 1000.0;
  EXPECT_EQ(device_difference("dau", first, renewed), "");
}

} // namespace
} // namespace dyncal::inline contract
