#include "drivers/files/npy_reader.hpp"

#include <cstring>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/files/file_playing.hpp"

namespace dyncal::drivers::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <class Number>
std::string bytes(Number value) {
  std::string text(sizeof(value), '\0');
  std::memcpy(text.data(), &value, sizeof(value));
  return text;
}

// As numpy.save writes format 1.0: the header is padded so that the rows begin at a multiple of 64.
std::string npy(const std::string& fields, std::size_t rows, const std::string& data) {
  std::string header = "{'descr': " + fields + ", 'fortran_order': False, 'shape': (" +
                       std::to_string(rows) + ",), }";
  header.append(64 - (10 + header.size() + 1) % 64, ' ');
  header += '\n';
  return "\x93NUMPY" + std::string("\x01\x00", 2) +
         bytes(static_cast<std::uint16_t>(header.size())) + header + data;
}

std::string problem_with(const std::string& text, FileSettings settings = {}) {
  const TemporaryFile file("wrong.npy", text);
  settings.path = file.path();
  return problem_of(settings);
}

TEST(NpyReader, PlaysStampsAndChannelsOfEveryType) {
  std::string data;
  for (int i = 0; i < 3; ++i) {
    data += bytes(std::int64_t{1'700'000'000'123'456'789} + i * i) + bytes(0.1 * i) +
            bytes(static_cast<std::int16_t>(-5 * i)) + bytes(0.5F * static_cast<float>(i)) +
            std::string(3, 'x') + bytes(static_cast<std::uint8_t>(250 + i)) +
            bytes(static_cast<std::uint32_t>(4'000'000'000U));
  }
  const TemporaryFile file(
      "types.npy",
      npy("[('t_ns', '<i8'), ('sync', '<f8'), ('z', '<i2'), ('f', '<f4'), ('', '|V3'), "
          "('b', '|u1'), ('u', '<u4')]",
          3, data));
  FileSettings settings;
  settings.path = file.path();
  settings.units = {{"sync", "\\volt"}};
  FileSource source(settings);
  const auto description = source.describe();
  ASSERT_TRUE(description) << description.error().message;
  ASSERT_EQ(description->channels.size(), 5U);
  EXPECT_EQ(description->channels[0].name, "sync");
  EXPECT_EQ(description->channels[0].unit, "\\volt");
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  EXPECT_THAT(sink.stamps_ns, ElementsAre(1'700'000'000'123'456'789, 1'700'000'000'123'456'790,
                                          1'700'000'000'123'456'793));
  EXPECT_THAT(sink.channel(0), ElementsAre(0.0, 0.1, 0.2));
  EXPECT_THAT(sink.channel(1), ElementsAre(0.0, -5.0, -10.0));
  EXPECT_THAT(sink.channel(2), ElementsAre(0.0, 0.5, 1.0));
  EXPECT_THAT(sink.channel(3), ElementsAre(250.0, 251.0, 252.0));
  EXPECT_THAT(sink.channel(4), ElementsAre(4e9, 4e9, 4e9));
}

TEST(NpyReader, UnderstandsTheLiteralsOfPython) {
  const std::string row = bytes(std::int64_t{1}) + bytes(0.5);
  std::string text =
      npy(R"([('t_ns', '<i8'), ('a [\\metre\\second\\tothe{-2}]\xb5\'', '<f8')])", 1, row);
  const TemporaryFile file("escaped.npy", text);
  const auto description = FileSource(settings_for(file)).describe();
  ASSERT_TRUE(description) << description.error().message;
  EXPECT_EQ(description->channels[0].name, "a [\\metre\\second\\tothe{-2}]\u00b5'");

  text = npy("[(u't_ns', '<i8'), (u'a', '<f8')]", 1, row);
  text.replace(text.find("(1,)"), 5, "(1L,)"); // eats a blank of the padding
  const TemporaryFile old("python2.npy", text);
  const auto of_python_2 = FileSource(settings_for(old)).describe();
  ASSERT_TRUE(of_python_2) << of_python_2.error().message;
  EXPECT_EQ(of_python_2->channels[0].name, "a");
}

TEST(NpyReader, ShowsGapsOfTheSampleNumber) {
  std::string data;
  for (const std::int64_t number : {7, 8, 10, 11}) {
    data += bytes(number) + bytes(10 * number) + bytes(1.0);
  }
  const TemporaryFile file(
      "gap.npy", npy("[('sample_number', '<i8'), ('t_ns', '<i8'), ('z', '<f8')]", 4, data));
  FileSettings settings;
  settings.path = file.path();
  FileSource source(settings);
  ASSERT_TRUE(source.describe());
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  EXPECT_THAT(sink.numbers, ElementsAre(7, 8, 10, 11));
  EXPECT_THAT(sink.stamps_ns, ElementsAre(70, 80, 100, 110));
  EXPECT_EQ(sink.blocks.size(), 2U);
}

TEST(NpyReader, TakesTheRateWhereThereIsNoTime) {
  FileSettings settings;
  settings.sample_rate = sample_rate_from_hz(1000.0);
  EXPECT_EQ(problem_with(npy("[('z', '<f8')]", 2, bytes(1.0) + bytes(2.0)), settings), "");
  EXPECT_THAT(problem_with(npy("[('z', '<f8')]", 2, bytes(1.0) + bytes(2.0))),
              HasSubstr("no field t_ns, and no sample rate is given"));
}

TEST(NpyReader, SaysWhatIsWrong) {
  const std::string two = bytes(std::int64_t{5}) + bytes(1.0) + bytes(std::int64_t{4}) + bytes(1.0);
  const std::string fields = "[('t_ns', '<i8'), ('z', '<f8')]";
  EXPECT_THAT(problem_with("t_ns,z\n0,1\n"), HasSubstr("wrong.npy: is not a NumPy file"));
  EXPECT_THAT(problem_with(npy("'<f8'", 2, two)), HasSubstr("holds no structured array"));
  EXPECT_THAT(problem_with(npy("[('t_ns', '>i8')]", 2, two)),
              HasSubstr("field 't_ns' of type '>i8'"));
  EXPECT_THAT(problem_with(npy("[('t_ns', '<i8'), ('z', '<f8', (3,))]", 2, two)),
              HasSubstr("field 'z' that is not a plain number"));
  EXPECT_THAT(problem_with(npy("[('t_ns', '<f8'), ('z', '<f8')]", 2, two)),
              HasSubstr("'t_ns' must hold integers"));
  EXPECT_THAT(problem_with(npy(fields, 3, two)), HasSubstr("ends before its 3 rows do"));
  EXPECT_EQ(problem_with(npy(fields, 2, two)), ""); // a stamp that falls is flagged
  EXPECT_THAT(problem_with(npy(fields, 0, "")), HasSubstr("no samples"));
  EXPECT_THAT(problem_with(npy(fields, 2, two).substr(0, 20)), HasSubstr("ends within its header"));
}

TEST(NpyReader, SurvivesHeadersCutAnywhere) {
  const std::string whole =
      npy("[('t_ns', '<i8'), ('z', '<f8')]", 1, bytes(std::int64_t{5}) + bytes(1.0));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_NE(problem_with(whole.substr(0, length)), "") << length;
    std::string spoiled = whole;
    spoiled[length] = '~';
    (void)problem_with(spoiled);
  }
}

TEST(NpyReader, TellsHowMuchIsRead) {
  std::string data;
  for (int i = 0; i < 10'000; ++i) {
    data += bytes(std::int64_t{1000} * i) + bytes(0.1 * i);
  }
  const TemporaryFile file("share.npy", npy("[('t_ns', '<i8'), ('z', '<f8')]", 10'000, data));
  const std::vector<double> shares = shares_of(settings_for(file));
  expect_rising_to_one(shares);
  EXPECT_DOUBLE_EQ(shares[1], 0.4098);
}

} // namespace
} // namespace dyncal::drivers::files
