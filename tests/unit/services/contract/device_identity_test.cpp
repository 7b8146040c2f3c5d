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

drivers::SourceDescription described(const std::string& unit) {
  drivers::SourceDescription description;
  for (const char* name : {"x", "sync"}) {
    drivers::ChannelDescription& channel = description.channels.emplace_back();
    channel.name = name;
    channel.unit = name == std::string("x") ? unit : R"(\volt)";
    channel.minimum = -4.0;
    channel.maximum = 2.0;
    channel.resolution = 0.5;
  }
  return description;
}

DeviceIdentity with_unit(const std::string& written) {
  DeviceIdentity identity;
  identity.units = {{"x", *parse_channel_unit(written)}};
  return identity;
}

TEST(DeviceIdentity, ConvertsChannelsIntoDsi) {
  const auto stated = with_identity(described(""), with_unit("g"));
  EXPECT_EQ(stated.channels[0].unit, R"(\metre\second\tothe{-2})");
  EXPECT_EQ(stated.channels[0].quantity, "from g");
  EXPECT_DOUBLE_EQ(stated.channels[0].minimum, -4.0 * 9.80665);
  EXPECT_DOUBLE_EQ(stated.channels[0].resolution, 0.5 * 9.80665);
  EXPECT_EQ(stated.channels[1].unit, R"(\volt)");
  EXPECT_EQ(stated.channels[1].minimum, -4.0);
  std::vector<double> values{1.0, 2.0, 3.0, 4.0};
  convert(unit_factors(described(""), with_unit("g")), 2, values);
  EXPECT_EQ(values, (std::vector<double>{9.80665, 2 * 9.80665, 3.0, 4.0}));
  const auto turned = with_identity(described(""), with_unit("-1 LSB/(m/s^2)"));
  EXPECT_EQ(turned.channels[0].minimum, -2.0);
  EXPECT_EQ(turned.channels[0].maximum, 4.0);
}

TEST(DeviceIdentity, ConvertsWhatAFileItselfSaysToBeInG) {
  EXPECT_EQ(with_identity(described("g"), {}).channels[0].unit, R"(\metre\second\tothe{-2})");
  EXPECT_EQ(unit_factors(described("g"), {}), (std::vector<double>{9.80665, 1.0}));
  EXPECT_EQ(with_identity(described("furlong"), {}).channels[0].unit, "furlong");
  EXPECT_TRUE(unit_factors(described("furlong"), {}).empty());
  EXPECT_TRUE(unit_factors(described(R"(\volt)"), {}).empty());
}

TEST(DeviceIdentity, DoubtsUnitsThatTheInstrumentContradicts) {
  const std::string m_s2 = R"(\metre\second\tothe{-2})";
  ASSERT_EQ(unit_doubts(described(m_s2), with_unit("g")).size(), 1U);
  EXPECT_NE(unit_doubts(described(m_s2), with_unit("g"))[0].find("by its source to be in m/s^2"),
            std::string::npos);
  EXPECT_TRUE(unit_doubts(described(""), with_unit("g")).empty());
  EXPECT_TRUE(unit_doubts(described(R"(\volt)"), with_unit("100 mV/g")).empty());
  EXPECT_TRUE(check_units(described(""), with_unit("g")));
  DeviceIdentity other = with_unit("g");
  other.units = {{"y", other.units.at("x")}};
  EXPECT_FALSE(check_units(described(""), other));
}

} // namespace
} // namespace dyncal::inline contract
