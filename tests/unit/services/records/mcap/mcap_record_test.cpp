#include "services/records/mcap/mcap_record.hpp"

#include <gtest/gtest.h>

#include "tests/unit/services/records/mcap/recorded_example.hpp"

namespace dyncal::inline records::recording {
namespace {

std::string bytes_of(const std::string& hexadecimal) {
  std::string bytes;
  std::string digits;
  for (const char letter : hexadecimal) {
    if (letter == ' ' || letter == '\n') {
      continue;
    }
    digits += letter;
    if (digits.size() == 2) {
      bytes.push_back(static_cast<char>(std::stoi(digits, nullptr, 16)));
      digits.clear();
    }
  }
  return bytes;
}

const Schema schema{1, "m::A", "omgidl", "module m { struct A { long a; }; };"};
const Channel channel{1, 1, "T", "cdr", {{"k", "v"}}};

// A whole file as the format's own Python library 1.6.0 writes it: two messages of one topic.
const char* const schema_bytes =
    "033b00000000000000 0100 04000000 6d3a3a41 06000000 6f6d6769646c 23000000 "
    "6d6f64756c65206d207b207374727563742041207b206c6f6e6720613b207d3b207d3b";
const char* const channel_bytes =
    "041e00000000000000 0100 0100 01000000 54 03000000 636472 0a000000 01000000 6b 01000000 76";
const char* const message_bytes =
    "051e00000000000000 0100 01000000 e803000000000000 e803000000000000 00010000 07000000";
const char* const second_message_bytes =
    "051e00000000000000 0100 02000000 d007000000000000 d007000000000000 00010000 08000000";
const char* const index_bytes = "072600000000000000 0100 20000000 e803000000000000 "
                                "6b00000000000000 d007000000000000 9200000000000000";
const char* const statistics_bytes =
    "0b3800000000000000 0200000000000000 0100 01000000 00000000 00000000 01000000 "
    "e803000000000000 d007000000000000 0a000000 0100 0200000000000000";
const char* const chunk_index_bytes =
    "084a00000000000000 e803000000000000 d007000000000000 1a00000000000000 ea00000000000000 "
    "0a000000 0100 0401000000000000 2f00000000000000 00000000 b900000000000000 b900000000000000";

std::string file_of_another_library() {
  return bytes_of(
      std::string("894d434150300d0a 010900000000000000 00000000 01000000 78 "
                  "06e100000000000000 e803000000000000 d007000000000000 b900000000000000 "
                  "f6a13ad7 00000000 b900000000000000") +
      schema_bytes + channel_bytes + message_bytes + second_message_bytes + index_bytes +
      "0f0400000000000000 00000000" + schema_bytes + channel_bytes + statistics_bytes +
      chunk_index_bytes +
      "0e1100000000000000 03 4001000000000000 4400000000000000"
      "0e1100000000000000 04 8401000000000000 2700000000000000"
      "0e1100000000000000 0b ab01000000000000 4100000000000000"
      "0e1100000000000000 08 ec01000000000000 5300000000000000"
      "0e1100000000000000 0a 3f02000000000000 0000000000000000"
      "0e1100000000000000 0d 3f02000000000000 0000000000000000"
      "021400000000000000 4001000000000000 3f02000000000000 7aeb3d62 894d434150300d0a");
}

TEST(McapRecord, IsWrittenAsTheFormatsOwnLibraryDoes) {
  std::string out;
  append_schema(out, schema);
  EXPECT_EQ(out, bytes_of(schema_bytes));
  out.clear();
  append_channel(out, channel);
  EXPECT_EQ(out, bytes_of(channel_bytes));
  out.clear();
  const std::string data = bytes_of("00010000 07000000");
  append_message(out, {1, 1, 1000, 1000, data});
  EXPECT_EQ(out, bytes_of(message_bytes));
  out.clear();
  append_message_index(out, 1, {{1000, 0x6b}, {2000, 0x92}});
  EXPECT_EQ(out, bytes_of(index_bytes));
  out.clear();
  append_statistics(out, {2, 1, 1, 0, 0, 1, 1000, 2000, {{1, 2}}});
  EXPECT_EQ(out, bytes_of(statistics_bytes));
  out.clear();
  append_chunk_index(out, {1000, 2000, 26, 234, {{1, 260}}, 47, "", 185, 185});
  EXPECT_EQ(out, bytes_of(chunk_index_bytes));
}

TEST(McapRecord, ReadsAWholeFileOfTheFormatsOwnLibrary) {
  const std::string file = file_of_another_library();
  ASSERT_EQ(file.size(), 768U);
  RecordingReader reader = reader_of(file);
  std::vector<std::uint32_t> sequences;
  const auto report = reader.scan({.message = [&](const MessageInFile& one) {
    EXPECT_EQ(one.channel, channel);
    ASSERT_NE(one.schema, nullptr);
    EXPECT_EQ(*one.schema, schema);
    EXPECT_EQ(one.message.data.size(), 8U);
    EXPECT_EQ(one.message.data[4], one.message.sequence == 1 ? 7 : 8);
    sequences.push_back(one.message.sequence);
  }});
  ASSERT_TRUE(report);
  EXPECT_EQ(sequences, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(report->library, "x");
  EXPECT_EQ(report->damage_count, 0U);
  EXPECT_TRUE(report->ended_in_order);
}

TEST(McapRecord, HasTheCrcOfZlib) {
  EXPECT_EQ(crc32_of("123456789"), 0xCBF43926U);
  EXPECT_EQ(crc32_of("6789", crc32_of("12345")), 0xCBF43926U);
  EXPECT_EQ(joined_crc32(crc32_of("12345"), crc32_of("6789"), 4), 0xCBF43926U);
}

TEST(McapRecord, IsRefusedWhenALengthDoesNotFit) {
  std::string out;
  append_channel(out, channel);
  const std::string content = out.substr(head_bytes);
  ASSERT_TRUE(parse_channel(content));
  for (std::size_t size = 0; size < content.size(); ++size) {
    EXPECT_FALSE(parse_channel(content.substr(0, size))) << size;
  }
  EXPECT_FALSE(parse_channel(content + '\0'));
  EXPECT_FALSE(parse_schema(""));
  EXPECT_FALSE(parse_chunk(std::string(39, '\xff')));
  EXPECT_FALSE(parse_chunk(std::string(400, '\xff')));
}

} // namespace
} // namespace dyncal::inline records::recording
