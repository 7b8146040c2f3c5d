#include "drivers/files/sigmf_reader.hpp"

#include <cstring>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/files/file_playing.hpp"

namespace dyncal::drivers::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Recording {
public:
  Recording(const std::string& global, const std::string& captures, const std::string& data)
      : meta_("made.sigmf-meta", "{\"global\": {\"core:version\": \"1.2.0\", " + global +
                                     "}, \"captures\": [" + captures + "], \"annotations\": []}"),
        data_("made.sigmf-data", data) {}
  [[nodiscard]] FileSettings settings() const { return settings_for(meta_); }
  [[nodiscard]] FileSettings settings_by_data() const { return settings_for(data_); }

private:
  TemporaryFile meta_;
  TemporaryFile data_;
};

template <class... Numbers>
std::string bytes(Numbers... numbers) {
  std::string text;
  const auto add = [&text](auto number) {
    std::string one(sizeof(number), '\0');
    std::memcpy(one.data(), &number, sizeof(number));
    text += one;
  };
  (add(numbers), ...);
  return text;
}

std::string i16(std::initializer_list<int> numbers) {
  std::string text;
  for (const int number : numbers) {
    text += bytes(static_cast<std::int16_t>(number));
  }
  return text;
}

constexpr const char* complex_counts = R"("core:datatype": "ci16_le", "core:sample_rate": 1000)";

TEST(SigmfReader, ReadsCountsAsIAndQ) {
  const Recording recording(
      complex_counts, R"({"core:sample_start": 0, "core:datetime": "2024-01-01T00:00:00.25Z"})",
      i16({1, -2, 3, -4, 32767, -32768}));
  for (const FileSettings& settings : {recording.settings(), recording.settings_by_data()}) {
    FileSource source(settings);
    const auto description = source.describe();
    ASSERT_TRUE(description) << description.error().message;
    ASSERT_EQ(description->channels.size(), 2U);
    EXPECT_EQ(description->channels[0].name, "i");
    EXPECT_EQ(description->channels[1].name, "q");
    EXPECT_EQ(description->channels[0].minimum, -32768.0);
    EXPECT_EQ(description->channels[0].maximum, 32767.0);
    CollectingSink sink;
    ASSERT_TRUE(source.run(sink));
    EXPECT_THAT(sink.channel(0), ElementsAre(1.0, 3.0, 32767.0));
    EXPECT_THAT(sink.channel(1), ElementsAre(-2.0, -4.0, -32768.0));
    EXPECT_THAT(sink.stamps_ns, ElementsAre(1'704'067'200'250'000'000, 1'704'067'200'251'000'000,
                                            1'704'067'200'252'000'000));
  }
}

TEST(SigmfReader, ReadsEveryTypeAndOrder) {
  const std::pair<const char*, std::string> cases[] = {
      {"rf32_le", bytes(1.0F, 2.0F)},
      {"rf64_le", bytes(1.0, 2.0)},
      {"ri8", bytes(std::int8_t{1}, std::int8_t{2})},
      {"ru8", bytes(std::uint8_t{1}, std::uint8_t{2})},
      {"ri16_be", std::string("\x00\x01\x00\x02", 4)},
      {"ru16_le", bytes(std::uint16_t{1}, std::uint16_t{2})},
      {"ri32_le", bytes(std::int32_t{1}, std::int32_t{2})},
      {"ru32_be", std::string("\0\0\0\1\0\0\0\2", 8)},
      {"rf32_be", std::string("\x3f\x80\0\0\x40\0\0\0", 8)}};
  for (const auto& [type, data] : cases) {
    const Recording recording(std::string(R"("core:sample_rate": 2, "core:datatype": ")") + type +
                                  "\"",
                              R"({"core:sample_start": 0})", data);
    FileSource source(recording.settings());
    const auto description = source.describe();
    ASSERT_TRUE(description) << description.error().message;
    CollectingSink sink;
    ASSERT_TRUE(source.run(sink));
    EXPECT_EQ(description->channels[0].name, "channel_1");
    EXPECT_THAT(sink.channel(0), ElementsAre(1.0, 2.0)) << type;
  }
}

TEST(SigmfReader, NumbersChannelsWhereThereAreSeveral) {
  const Recording recording(
      R"("core:datatype": "ci16_le", "core:sample_rate": 10, "core:num_channels": 2)", "",
      i16({1, 2, 3, 4, 5, 6, 7, 8}));
  FileSource source(recording.settings());
  const auto description = source.describe();
  ASSERT_TRUE(description) << description.error().message;
  ASSERT_EQ(description->channels.size(), 4U);
  EXPECT_EQ(description->channels[3].name, "q_2");
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  EXPECT_THAT(sink.channel(3), ElementsAre(4.0, 8.0));
}

TEST(SigmfReader, ShowsGapsBetweenCaptures) {
  const std::string first = R"({"core:sample_start": 0, "core:datetime": "2024-01-01T00:00:00Z")";
  // By the number, by the time, and at once.
  const Recording numbered(complex_counts, first + R"(, "core:global_index": 100},
                           {"core:sample_start": 2, "core:global_index": 105},
                           {"core:sample_start": 3}, {"core:sample_start": 3})",
                           i16({0, 0, 1, 0, 2, 0, 3, 0}));
  FileSource source(numbered.settings());
  ASSERT_TRUE(source.describe());
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  EXPECT_THAT(sink.numbers, ElementsAre(0, 1, 5, 6));
  EXPECT_EQ(sink.stamps_ns[2] - sink.stamps_ns[0], 5'000'000);
  EXPECT_EQ(sink.counts.lost_in_device, 3U);

  const Recording timed(complex_counts,
                        first + R"(}, {"core:sample_start": 1, "core:header_bytes": 3,
                        "core:datetime": "2024-01-01T00:00:00.0104Z"})",
                        i16({7, 0}) + "xyz" + i16({8, 0, 9, 0}));
  FileSource by_time(timed.settings());
  ASSERT_TRUE(by_time.describe());
  CollectingSink later;
  ASSERT_TRUE(by_time.run(later));
  EXPECT_THAT(later.numbers, ElementsAre(0, 10, 11));
  EXPECT_THAT(later.channel(0), ElementsAre(7.0, 8.0, 9.0));
}

TEST(SigmfReader, SaysWhatIsWrongAndWhere) {
  const auto problem = [](const std::string& global, const std::string& captures,
                          const std::string& data = i16({1, 2})) {
    return problem_of(Recording(global, captures, data).settings());
  };
  EXPECT_EQ(problem(complex_counts, ""), "");
  EXPECT_THAT(problem("\"x\": }", ""), HasSubstr("made.sigmf-meta: is not the metadata"));
  EXPECT_THAT(problem(R"("core:datatype": "ci12_le", "core:sample_rate": 1)", ""),
              HasSubstr("core:datatype \"ci12_le\" is none of those"));
  EXPECT_THAT(problem(R"("core:datatype": "ci16", "core:sample_rate": 1)", ""),
              HasSubstr("core:datatype \"ci16\""));
  EXPECT_THAT(problem(R"("core:datatype": "ci16_le")", ""), HasSubstr("core:sample_rate is not"));
  EXPECT_THAT(problem(R"("core:datatype": "ci16_le", "core:dataset": "x.bin")", ""),
              HasSubstr("core:dataset is there"));
  EXPECT_THAT(problem(complex_counts, "", i16({1, 2, 3})),
              HasSubstr("capture 0 needs samples of 4 bytes from byte 0 on, but the data file ends "
                        "at byte 6"));
  EXPECT_THAT(problem(complex_counts, R"({"core:sample_start": 5})"),
              HasSubstr("capture 0 needs samples of 4 bytes from byte 20 on"));
  EXPECT_THAT(problem(complex_counts, R"({"core:sample_start": -1})"),
              HasSubstr("capture 0: core:sample_start must be a whole number"));
  EXPECT_THAT(problem(complex_counts, R"({"core:sample_start": 1}, {"core:sample_start": 0})"),
              HasSubstr("capture 1 begins before the one before it"));
  EXPECT_THAT(problem(complex_counts, R"({"core:sample_start": 0, "core:datetime": "yesterday"})"),
              HasSubstr("capture 0: core:datetime must be a time"));
  EXPECT_THAT(problem(complex_counts,
                      R"({"core:sample_start": 0, "core:datetime": "2024-01-01T00:00:00Z"},
                      {"core:sample_start": 1, "core:datetime": "2023-01-01T00:00:00Z"})"),
              HasSubstr("capture 1 begins before the last sample"));
  const TemporaryFile alone("alone.sigmf-meta", "{}");
  EXPECT_THAT(problem_of(settings_for(alone)),
              HasSubstr("alone.sigmf-data: cannot read this file"));
}

TEST(SigmfTime, IsExactToTheNanosecond) {
  EXPECT_EQ(sigmf_unix_ns("1970-01-01T00:00:00Z"), 0);
  EXPECT_EQ(sigmf_unix_ns("2024-02-29T23:59:59.123456789Z"), 1'709'251'199'123'456'789);
  EXPECT_EQ(sigmf_unix_ns("2024-02-29T23:59:59.1234567891Z"), 1'709'251'199'123'456'789);
  for (const char* text :
       {"", "2024-02-30T00:00:00Z", "2024-01-01T24:00:00Z", "2024-01-01 00:00:00Z",
        "2024-01-01T00:00:00", "2024-01-01T00:00:00.xZ", "2024-01-01T00:00:00+Z"}) {
    EXPECT_FALSE(sigmf_unix_ns(text)) << text;
  }
}

} // namespace
} // namespace dyncal::drivers::files
