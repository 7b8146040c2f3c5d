#include "drivers/smartup/description.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/smartup/datagram_writer.hpp"
#include "tests/unit/drivers/smartup/wire_vectors.hpp"

namespace dyncal::drivers::smartup {
namespace {

using testing::ElementsAre;

DescriptionMessage message_of(std::span<const std::uint8_t> bytes) {
  Datagram datagram;
  decode(bytes, datagram);
  EXPECT_EQ(datagram.descriptions.size(), 1U);
  return datagram.descriptions.at(0);
}

DescriptionAssembly mpu9250() {
  DescriptionAssembly assembly;
  for (const auto& bytes : tests::mpu9250_descriptions(0xbccb0100)) {
    assembly.add(message_of(bytes));
  }
  return assembly;
}

DescriptionAssembly with_hierarchy(const std::vector<std::string>& texts) {
  DescriptionAssembly assembly;
  assembly.add(message_of(tests::DatagramWriter("DSCP").description(1, "x", 6, texts).bytes()));
  return assembly;
}

std::vector<std::string> names(const std::vector<ChannelDescription>& channels) {
  std::vector<std::string> names;
  for (const auto& channel : channels) {
    names.push_back(channel.name);
  }
  return names;
}

TEST(Description, NamesChannelsFromTheirHierarchy) {
  EXPECT_THAT(names(mpu9250().channels(0x3ff, {})),
              ElementsAre("acceleration_x", "acceleration_y", "acceleration_z",
                          "angular_velocity_x", "angular_velocity_y", "angular_velocity_z",
                          "magnetic_flux_density_x", "magnetic_flux_density_y",
                          "magnetic_flux_density_z", "temperature"));
}

TEST(Description, IsCompleteWithSixKinds) {
  DescriptionAssembly assembly;
  int messages = 0;
  for (const auto& bytes : tests::mpu9250_descriptions(1)) {
    EXPECT_FALSE(assembly.complete());
    EXPECT_TRUE(assembly.add(message_of(bytes)));
    EXPECT_FALSE(assembly.add(message_of(bytes))) << "said already";
    ++messages;
  }
  EXPECT_EQ(messages, 6);
  EXPECT_TRUE(assembly.complete());
}

TEST(Description, ResolutionIsTheNumberOfStepsOfTheRange) {
  const auto channels = mpu9250().channels(1, {});
  EXPECT_FLOAT_EQ(static_cast<float>(channels[0].minimum), -156.9F);
  EXPECT_FLOAT_EQ(static_cast<float>(channels[0].maximum), 156.9F);
  EXPECT_NEAR(channels[0].resolution, 2 * 156.9 / 65536, 1e-8);
  EXPECT_EQ(channels[0].unit, R"(\metre\second\tothe{-2})");
  EXPECT_EQ(channels[0].quantity, "X Acceleration");
}

TEST(Description, KeepsUndeclaredChannelsAndLetsTheBenchNameThem) {
  const auto channels = mpu9250().channels(0x1fff, {.names = {{"Data_11", "sync"}}, .units = {}});
  ASSERT_EQ(channels.size(), 13U);
  EXPECT_EQ(channels[10].name, "sync");
  EXPECT_EQ(channels[10].unit, "\\volt");
  EXPECT_EQ(channels[11].name, "data_12");
  EXPECT_EQ(channels[12].name, "data_13");
}

TEST(Description, OnlyPresentChannelsAreColumns) {
  EXPECT_THAT(names(mpu9250().channels(0b1000000111, {})),
              ElementsAre("acceleration_x", "acceleration_y", "acceleration_z", "temperature"));
}

TEST(Description, DeclaredChannelsCanBeRenamedByAnyOfTheirNames) {
  const ChannelNaming naming{
      .names = {{"acceleration/0", "ax"}, {"data_02", "ay"}, {"acceleration_z", "az"}},
      .units = {{"az", "\\one"}}};
  const auto channels = mpu9250().channels(0b111, naming);
  EXPECT_THAT(names(channels), ElementsAre("ax", "ay", "az"));
  EXPECT_EQ(channels[2].unit, "\\one");
}

TEST(Description, NothingDeclaredGivesNumberedNames) {
  EXPECT_THAT(names(DescriptionAssembly().channels(0b101, {})), ElementsAre("data_01", "data_03"));
  EXPECT_THAT(names(DescriptionAssembly().channels(0b101, {}, "sync_")),
              ElementsAre("sync_data_01", "sync_data_03"));
}

TEST(Description, VoltagesKeepTheirNumbers) {
  EXPECT_THAT(names(with_hierarchy({"Voltage/0", "Voltage/1", "Voltage/2"}).channels(0b111, {})),
              ElementsAre("voltage_0", "voltage_1", "voltage_2"));
}

TEST(Description, GroupsOfTwoKeepTheirNumbers) {
  EXPECT_THAT(names(with_hierarchy({"Acceleration/0", "Acceleration/1"}).channels(0b11, {})),
              ElementsAre("acceleration_0", "acceleration_1"));
}

TEST(Description, HierarchyWithoutIndexIsWarnedOfAndUsed) {
  DescriptionAssembly assembly;
  assembly.add(message_of(tests::wire_vector("dscp_hierarchy_malformed")));
  EXPECT_THAT(names(assembly.channels(0b11, {})), ElementsAre("temperature", "pressure"));
  EXPECT_THAT(assembly.warnings(), ElementsAre("Data_02: hierarchy without index: 'Pressure'"));
}

TEST(Description, EqualNamesAreToldApart) {
  EXPECT_THAT(names(with_hierarchy({"Pressure", "Pressure"}).channels(0b11, {})),
              ElementsAre("pressure", "pressure_02"));
}

TEST(Description, OddHierarchiesGiveUsableNames) {
  EXPECT_THAT(names(with_hierarchy(
                        {"/0", "Relative humidity/0", "Acceleration/x", "A/99999999999999999999"})
                        .channels(0b1111, {})),
              ElementsAre("data_01", "relative_humidity", "acceleration", "a"));
}

TEST(Description, KnownWrongUnitsAreCorrected) {
  EXPECT_EQ(d_si_unit("\\seconds"), "\\second");
  EXPECT_EQ(d_si_unit("\\nanoseconds"), "\\nano\\second");
  EXPECT_EQ(d_si_unit("\\A.U."), "\\one");
  EXPECT_EQ(d_si_unit("/hertz"), "\\hertz");
  EXPECT_EQ(d_si_unit("\\pascal"), "\\pascal");
  EXPECT_EQ(d_si_unit("furlong"), "furlong");
}

} // namespace
} // namespace dyncal::drivers::smartup
