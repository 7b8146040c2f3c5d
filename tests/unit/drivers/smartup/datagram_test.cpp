#include "drivers/smartup/datagram.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "smartup.pb.h"
#include "tests/unit/drivers/smartup/datagram_writer.hpp"
#include "tests/unit/drivers/smartup/wire_vectors.hpp"

namespace dyncal::drivers::smartup {
namespace {

using tests::DatagramWriter;

Datagram decoded(std::span<const std::uint8_t> bytes) {
  Datagram datagram;
  decode(bytes, datagram);
  return datagram;
}

Datagram decoded(std::string_view vector) {
  const auto bytes = tests::wire_vector(vector);
  EXPECT_FALSE(bytes.empty()) << vector;
  return decoded(bytes);
}

TEST(WireVectors, TwoSamplesOfTenChannels) {
  const auto datagram = decoded("data_mpu9250_10ch_x2");
  ASSERT_EQ(datagram.data.size(), 2U);
  EXPECT_FALSE(datagram.broken);
  EXPECT_EQ(datagram.data[0].sensor, 0xbccb0100U);
  EXPECT_EQ(datagram.data[0].sample_number, 1U);
  EXPECT_EQ(datagram.data[1].sample_number, 2U);
  EXPECT_EQ(datagram.data[0].present, 0x3ffU);
  EXPECT_EQ(datagram.data[0].values[0], 0.125F);
  EXPECT_EQ(datagram.data[0].values[1], -0.25F);
  EXPECT_EQ(datagram.data[0].values[9], 31.5F);
  EXPECT_EQ(datagram.data[0].time_uncertainty_ns, 84U);
  EXPECT_FALSE(datagram.data[0].time_ticks);
  EXPECT_EQ(datagram.data[0].bytes, 72U);
}

TEST(WireVectors, UndeclaredAdcChannelsAreKept) {
  const auto datagram = decoded("data_mpu9250_13ch");
  ASSERT_EQ(datagram.data.size(), 1U);
  EXPECT_EQ(datagram.data[0].present, 0x1fffU);
  EXPECT_EQ(datagram.data[0].values[10], 1.0F);
  EXPECT_EQ(datagram.data[0].values[11], -2.0F);
  EXPECT_EQ(datagram.data[0].values[12], 0.5F);
}

TEST(WireVectors, AbsentChannelsStayAbsent) {
  const auto datagram = decoded("data_bma280_sparse");
  ASSERT_EQ(datagram.data.size(), 1U);
  EXPECT_EQ(datagram.data[0].present, 0b1000000111U);
}

TEST(WireVectors, RawTicksAreRead) {
  const auto datagram = decoded("data_edge_ticks");
  ASSERT_EQ(datagram.data.size(), 1U);
  EXPECT_EQ(datagram.data[0].time_ticks, 12345678901234U);
}

TEST(WireVectors, SensorsAreInterleaved) {
  const auto datagram = decoded("data_interleaved");
  ASSERT_EQ(datagram.data.size(), 3U);
  EXPECT_EQ(datagram.data[0].sensor, 0xbccb0100U);
  EXPECT_EQ(datagram.data[0].sample_number, 10U);
  EXPECT_NE(datagram.data[1].sensor, datagram.data[0].sensor);
  EXPECT_EQ(datagram.data[2].sensor, 0xbccb0100U);
  EXPECT_EQ(datagram.data[2].sample_number, 12U);
}

TEST(WireVectors, SkippedConversionRepeatsTheStamp) {
  const auto before = decoded("data_interleaved");
  const auto datagram = decoded("data_uncertainty_raw_msw");
  ASSERT_EQ(datagram.data.size(), 1U);
  EXPECT_EQ(datagram.data[0].time_uncertainty_ns, 0x2cU);
  EXPECT_EQ(datagram.data[0].stamp_ns(), before.data[2].stamp_ns());
}

TEST(WireVectors, KeywordAloneIsAnEmptyDatagram) {
  const auto datagram = decoded("data_empty");
  EXPECT_TRUE(datagram.data.empty());
  EXPECT_TRUE(datagram.rejected.empty());
  EXPECT_FALSE(datagram.broken);
}

TEST(WireVectors, TruncatedMessageIsNamed) {
  const auto datagram = decoded("bad_truncated");
  EXPECT_TRUE(datagram.data.empty());
  EXPECT_EQ(datagram.broken, Rejection::truncated);
}

TEST(WireVectors, MessageWithoutRequiredFieldsIsRejectedAndTheNextOneRead) {
  const auto datagram = decoded("bad_missing_required");
  ASSERT_EQ(datagram.data.size(), 1U);
  EXPECT_EQ(datagram.data[0].sensor, 0xbccb0100U);
  ASSERT_EQ(datagram.rejected.size(), 1U);
  EXPECT_EQ(datagram.rejected[0].cause, Rejection::missing_field);
  EXPECT_EQ(datagram.rejected[0].sample_number, 2U);
}

TEST(WireVectors, LengthThatIsNoVarintIsNamed) {
  const auto datagram = decoded("bad_varint");
  EXPECT_TRUE(datagram.data.empty());
  EXPECT_EQ(datagram.broken, Rejection::bad_length);
}

TEST(WireVectors, UnknownKeywordIsNamed) {
  const auto datagram = decoded("bad_keyword");
  EXPECT_TRUE(datagram.data.empty());
  EXPECT_EQ(datagram.broken, Rejection::unknown_keyword);
}

TEST(WireVectors, UnitsOfOldFirmwareHaveNoTickField) {
  const auto datagram = decoded("dscp_unit_old");
  ASSERT_EQ(datagram.descriptions.size(), 1U);
  const auto& description = datagram.descriptions[0];
  EXPECT_EQ(description.type, DescriptionType::unit);
  EXPECT_EQ(description.sensor_name, "MPU 9250");
  EXPECT_FALSE(description.has_time_ticks);
  EXPECT_EQ(description.texts[0], R"(\metre\second\tothe{-2})");
  EXPECT_EQ(description.texts[9], R"(\degreecelsius)");
  EXPECT_FALSE(description.texts[10]);
}

TEST(WireVectors, UnitsOfNewFirmwareHaveTheTickField) {
  const auto datagram = decoded("dscp_unit_new");
  ASSERT_EQ(datagram.descriptions.size(), 1U);
  EXPECT_EQ(datagram.descriptions[0].type, DescriptionType::unit);
  EXPECT_EQ(datagram.descriptions[0].sensor_name, "MPU_9250");
  EXPECT_EQ(datagram.descriptions[0].has_time_ticks, false);
}

TEST(WireVectors, HierarchyIsRead) {
  const auto datagram = decoded("dscp_hierarchy");
  ASSERT_EQ(datagram.descriptions.size(), 1U);
  EXPECT_EQ(datagram.descriptions[0].type, DescriptionType::hierarchy);
  EXPECT_EQ(datagram.descriptions[0].texts[2], "Acceleration/2");
}

TEST(WireVectors, ResolutionIsRead) {
  const auto datagram = decoded("dscp_resolution");
  ASSERT_EQ(datagram.descriptions.size(), 1U);
  EXPECT_EQ(datagram.descriptions[0].type, DescriptionType::resolution);
  EXPECT_EQ(datagram.descriptions[0].numbers[0], 65536.0F);
  EXPECT_EQ(datagram.descriptions[0].numbers[6], 65520.0F);
  EXPECT_FALSE(datagram.descriptions[0].numbers[10]);
}

TEST(WireVectors, HierarchyWithoutIndexIsRead) {
  const auto datagram = decoded("dscp_hierarchy_malformed");
  ASSERT_EQ(datagram.descriptions.size(), 1U);
  EXPECT_EQ(datagram.descriptions[0].type, DescriptionType::hierarchy);
  EXPECT_EQ(datagram.descriptions[0].texts[1], "Pressure");
}

TEST(Datagram, MessagesBeforeABrokenFrameAreKept) {
  auto bytes = DatagramWriter("DATA").data({.sample_number = 7}).bytes();
  bytes.push_back(100);
  bytes.push_back(8);
  const auto datagram = decoded(bytes);
  ASSERT_EQ(datagram.data.size(), 1U);
  EXPECT_EQ(datagram.data[0].sample_number, 7U);
  EXPECT_EQ(datagram.broken, Rejection::truncated);
}

TEST(Datagram, UnknownFieldsAreSkipped) {
  std::vector<std::uint8_t> message;
  for (int field = 1; field <= 5; ++field) {
    DatagramWriter::number(message, field, 9);
  }
  DatagramWriter::text(message, 100, "of a later firmware");
  DatagramWriter::number(message, 200, UINT64_MAX);
  DatagramWriter::real(message, 300, 1.0F);
  DatagramWriter::real(message, 6, 0.0F);
  const auto datagram = decoded(DatagramWriter("DATA").frame(message).bytes());
  ASSERT_EQ(datagram.data.size(), 1U);
  EXPECT_EQ(datagram.data[0].present, 1U);
}

TEST(Datagram, MalformedFieldsAreRejected) {
  const std::vector<std::vector<std::uint8_t>> messages = {
      {0x00, 0x01},       // field number 0
      {0x0b, 0x01},       // a group
      {0x0e, 0x01},       // no such wire type
      {0x35, 0x00, 0x00}, // half a float
      {0x08, 0xff, 0xff}, // half a varint
      {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01, 0x00}};
  for (const auto& message : messages) {
    const auto datagram =
        decoded(DatagramWriter("DATA").frame(message).data({.sample_number = 3}).bytes());
    ASSERT_EQ(datagram.rejected.size(), 1U);
    EXPECT_EQ(datagram.rejected[0].cause, Rejection::malformed);
    EXPECT_EQ(datagram.data.size(), 1U);
  }
}

TEST(Datagram, DescriptionsOfUnknownTypeAreRejected) {
  const auto datagram =
      decoded(DatagramWriter("DSCP").description(1, "x", 7, std::vector<std::string>{"a"}).bytes());
  ASSERT_EQ(datagram.rejected.size(), 1U);
  EXPECT_EQ(datagram.rejected[0].cause, Rejection::unknown_type);
  EXPECT_EQ(datagram.rejected[0].sensor, 1U);
}

TEST(Datagram, TextsMayFillTheirFieldWithoutNulOrEndBeforeIt) {
  const std::string forty(40, 'x');
  const std::string padded("y\0\0garbage", 10);
  const auto datagram =
      decoded(DatagramWriter("DSCP")
                  .description(1, "name", 0, std::vector<std::string>{forty, padded})
                  .bytes());
  ASSERT_EQ(datagram.descriptions.size(), 1U);
  EXPECT_EQ(datagram.descriptions[0].texts[0], forty);
  EXPECT_EQ(datagram.descriptions[0].texts[1], "y");
}

// The library of the format's makers, on the same schema, is the judge of what we read.
class AgainstProtobuf : public testing::Test {
protected:
  std::mt19937 random{20201012};

  std::vector<std::uint8_t> framed(const std::string& message) {
    return DatagramWriter("DATA").frame({message.begin(), message.end()}).bytes();
  }

  wire::DataMessage random_message() {
    wire::DataMessage message;
    const auto number = [&] { return static_cast<std::uint32_t>(random() >> (random() % 32)); };
    message.set_id(number());
    message.set_sample_number(number());
    message.set_unix_time(number());
    message.set_unix_time_nsecs(number());
    message.set_time_uncertainty(number());
    message.set_data_01(static_cast<float>(random()));
    if (random() % 2 != 0) {
      message.set_data_02(-1.5F);
    }
    if (random() % 2 != 0) {
      message.set_data_10(0.0F);
    }
    if (random() % 2 != 0) {
      message.set_data_11(3.0F);
    }
    if (random() % 2 != 0) {
      message.set_data_16(static_cast<float>(random()));
    }
    if (random() % 2 != 0) {
      message.set_time_ticks((std::uint64_t{random()} << 32U) | random());
    }
    return message;
  }

  static void expect_same(const wire::DataMessage& theirs, const DataMessage& ours) {
    EXPECT_EQ(ours.sensor, theirs.id());
    EXPECT_EQ(ours.sample_number, theirs.sample_number());
    EXPECT_EQ(ours.unix_time_s, theirs.unix_time());
    EXPECT_EQ(ours.nanoseconds, theirs.unix_time_nsecs());
    EXPECT_EQ(ours.time_uncertainty_ns, theirs.time_uncertainty());
    EXPECT_EQ(ours.values[0], theirs.data_01());
    EXPECT_EQ((ours.present & 2U) != 0, theirs.has_data_02());
    EXPECT_EQ((ours.present & (1U << 9U)) != 0, theirs.has_data_10());
    EXPECT_EQ((ours.present & (1U << 10U)) != 0, theirs.has_data_11());
    EXPECT_EQ((ours.present & (1U << 15U)) != 0, theirs.has_data_16());
    EXPECT_EQ(ours.values[15], theirs.data_16());
    EXPECT_EQ(ours.time_ticks.has_value(), theirs.has_time_ticks());
    EXPECT_EQ(ours.time_ticks.value_or(0), theirs.time_ticks());
  }
};

TEST_F(AgainstProtobuf, WholeMessagesAreReadAlike) {
  for (int i = 0; i < 2000; ++i) {
    const auto message = random_message();
    const auto datagram = decoded(framed(message.SerializeAsString()));
    ASSERT_EQ(datagram.data.size(), 1U);
    expect_same(message, datagram.data[0]);
  }
}

TEST_F(AgainstProtobuf, WhatWeAcceptOfDamagedMessagesIsReadAlike) {
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string bytes = random_message().SerializeAsString();
    for (auto damage = random() % 3; damage > 0; --damage) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    const auto datagram = decoded(framed(bytes));
    wire::DataMessage theirs;
    const bool they_accept = theirs.ParsePartialFromString(bytes) && theirs.IsInitialized();
    if (datagram.data.empty()) {
      continue;
    }
    ++accepted;
    ASSERT_TRUE(they_accept);
    const bool comparable = !std::isnan(theirs.data_01()) && !std::isnan(theirs.data_16());
    if (comparable) {
      expect_same(theirs, datagram.data[0]);
    }
  }
  EXPECT_GT(accepted, 5000);
}

TEST_F(AgainstProtobuf, DescriptionsAreReadAlike) {
  wire::DescriptionMessage message;
  message.set_id(0x60ad0500);
  message.set_sensor_name("MS5837_02BA");
  message.set_description_type(wire::DescriptionMessage::MAX_SCALE);
  message.set_f_data_01(85.0F);
  message.set_f_data_16(120000.0F);
  message.set_has_time_ticks(true);
  const std::string bytes = message.SerializeAsString();
  const auto datagram = decoded(DatagramWriter("DSCP").frame({bytes.begin(), bytes.end()}).bytes());
  ASSERT_EQ(datagram.descriptions.size(), 1U);
  EXPECT_EQ(datagram.descriptions[0].sensor_name, "MS5837_02BA");
  EXPECT_EQ(datagram.descriptions[0].type, DescriptionType::max_scale);
  EXPECT_EQ(datagram.descriptions[0].numbers[0], 85.0F);
  EXPECT_FALSE(datagram.descriptions[0].numbers[1]);
  EXPECT_EQ(datagram.descriptions[0].numbers[15], 120000.0F);
  EXPECT_EQ(datagram.descriptions[0].has_time_ticks, true);
}

} // namespace
} // namespace dyncal::drivers::smartup
