#include "drivers/virtual_bench/wire/smartup_format.hpp"

#include <cstring>
#include <gtest/gtest.h>
#include <map>

namespace dyncal::drivers::virtual_bench {
namespace {

// A decoder of its own, as far as these messages need one: field number -> raw value.
struct Message {
  std::map<std::uint32_t, std::uint64_t> numbers;
  std::map<std::uint32_t, float> floats;
  std::map<std::uint32_t, std::string> texts;
};

class Decoder {
public:
  explicit Decoder(const std::string& bytes) : bytes_(bytes) {}
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0;; shift += 7) {
      const auto byte = static_cast<unsigned char>(bytes_.at(at_++));
      value |= static_cast<std::uint64_t>(byte & 0x7fU) << shift;
      if (byte < 0x80U) {
        return value;
      }
    }
  }

  std::string take(std::size_t count) {
    const std::string part = bytes_.substr(at_, count);
    EXPECT_EQ(part.size(), count);
    at_ += count;
    return part;
  }

private:
  std::string bytes_;
  std::size_t at_ = 0;
};

Message decode(const std::string& bytes) {
  Message message;
  Decoder decoder(bytes);
  while (!decoder.at_end()) {
    const std::uint64_t key = decoder.varint();
    const auto field = static_cast<std::uint32_t>(key >> 3U);
    if ((key & 7U) == 0) {
      message.numbers[field] = decoder.varint();
    } else if ((key & 7U) == 2) {
      message.texts[field] = decoder.take(decoder.varint());
    } else {
      EXPECT_EQ(key & 7U, 5U);
      const std::string four = decoder.take(4);
      float value = 0.0F;
      std::memcpy(&value, four.data(), 4);
      message.floats[field] = value;
    }
  }
  return message;
}

std::vector<Message> decode_datagram(const std::string& datagram, const std::string& keyword) {
  Decoder decoder(datagram);
  EXPECT_EQ(decoder.take(4), keyword);
  std::vector<Message> messages;
  while (!decoder.at_end()) {
    messages.push_back(decode(decoder.take(decoder.varint())));
  }
  return messages;
}

std::string from_hex(const std::string& hex) {
  std::string bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    bytes.push_back(static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

UnitSample sample(std::uint32_t number, std::size_t channels) {
  UnitSample result;
  result.sample_number = number;
  result.utc_ns = 1'600'000'000'000'000'000 + static_cast<std::int64_t>(number) * 996'960;
  result.uncertainty_ns = 53;
  result.ticks = 12345678901234U;
  for (std::size_t i = 0; i < channels; ++i) {
    result.data[i] = static_cast<float>(number) + 0.25F * static_cast<float>(i);
  }
  return result;
}

TEST(SmartUpPacker, WritesTheBytesOfTheUnitsFormat) {
  // A message of 13 channels from the published test vectors for this format, with its length in
  // front.
  const std::string message = from_hex(
      "59088082ace60b100318d3fd90fc0520fc83e8172854350000003e3d000080be450ae81c414d6f12833a556f1203"
      "bb"
      "5da69b443b65000048416d0000f0c175000025427d0000fc4185010000803f8d01000000c095010000003f");
  UnitSample published;
  published.sample_number = 3;
  published.uncertainty_ns = 84;
  const Message expected = decode(message.substr(1));
  for (const auto& [field, value] : expected.floats) {
    published.data[field - 6] = value;
  }
  published.utc_ns = static_cast<std::int64_t>(expected.numbers.at(3)) * 1'000'000'000 +
                     static_cast<std::int64_t>(expected.numbers.at(4));
  SmartUpPacker packer(static_cast<std::uint32_t>(expected.numbers.at(1)), "MPU 9250", false);
  std::optional<std::string> datagram;
  std::string wanted = "DATA";
  while (!datagram) {
    datagram = packer.append(published);
    wanted += message;
  }
  EXPECT_EQ(*datagram, wanted);
}

TEST(SmartUpPacker, FillsDatagramsTo873To996Bytes) {
  for (const std::size_t channels : {4U, 10U, 13U, 16U}) {
    SmartUpPacker packer(0xbccb0100, "MPU 9250", true);
    std::uint32_t next = 1;
    for (std::uint32_t number = 1; number <= 500; ++number) {
      const auto datagram = packer.append(sample(number, channels));
      if (!datagram) {
        continue;
      }
      EXPECT_GE(datagram->size(), 873U);
      EXPECT_LE(datagram->size(), 996U);
      for (const Message& message : decode_datagram(*datagram, "DATA")) {
        EXPECT_EQ(message.numbers.at(1), 0xbccb0100U);
        EXPECT_EQ(message.numbers.at(2), next);
        const std::int64_t utc_ns = sample(next, channels).utc_ns;
        EXPECT_EQ(message.numbers.at(3), static_cast<std::uint64_t>(utc_ns / 1'000'000'000));
        EXPECT_EQ(message.numbers.at(4), static_cast<std::uint64_t>(utc_ns % 1'000'000'000));
        EXPECT_EQ(message.numbers.at(5), 53U);
        EXPECT_EQ(message.numbers.at(22), 12345678901234U);
        EXPECT_EQ(message.floats.size(), channels);
        EXPECT_EQ(message.floats.at(6), static_cast<float>(next));
        ++next;
      }
    }
    EXPECT_GT(next, 480U);
  }
}

TEST(SmartUpPacker, LeavesOutChannelsThatAreNotMeasured) {
  SmartUpPacker packer(1, "BMA 280", false);
  UnitSample sparse = sample(1, 3);
  sparse.data[9] = 25.0F;
  std::optional<std::string> datagram;
  while (!datagram) {
    datagram = packer.append(sparse);
  }
  const Message message = decode_datagram(*datagram, "DATA").front();
  EXPECT_EQ(message.floats.size(), 4U);
  EXPECT_EQ(message.floats.at(15), 25.0F);
  EXPECT_FALSE(message.numbers.contains(22));
}

TEST(SmartUpPacker, DescribesDeclaredChannelsInSixDatagrams) {
  const SmartUpPacker packer(0xbccb0100, "MPU 9250", true);
  const std::vector<UnitChannel> channels{
      {2, "acceleration_z", "Z Acceleration", "\\metre\\second\\tothe{-2}", "Acceleration/2", -20.0,
       20.0, 65536.0, true},
      {10, "sync", "Voltage", "\\volt", "Voltage/0", -10.0, 10.0, 4096.0, false}};
  const std::vector<std::string> datagrams = packer.descriptions(channels);
  ASSERT_EQ(datagrams.size(), 6U);
  std::map<std::uint64_t, Message> by_type;
  for (const std::string& datagram : datagrams) {
    const std::vector<Message> messages = decode_datagram(datagram, "DSCP");
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(messages[0].texts.at(2), "MPU 9250");
    EXPECT_EQ(messages[0].numbers.at(36), 1U);
    by_type[messages[0].numbers.at(3)] = messages[0];
  }
  EXPECT_EQ(by_type.at(0).texts.at(6), "Z Acceleration");
  EXPECT_EQ(by_type.at(1).texts.at(6), "\\metre\\second\\tothe{-2}");
  EXPECT_EQ(by_type.at(3).floats.at(22), 65536.0F);
  EXPECT_EQ(by_type.at(4).floats.at(22), -20.0F);
  EXPECT_EQ(by_type.at(5).floats.at(22), 20.0F);
  EXPECT_EQ(by_type.at(6).texts.at(6), "Acceleration/2");
  EXPECT_FALSE(by_type.at(0).texts.contains(14)); // the sync ADC is not declared
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
