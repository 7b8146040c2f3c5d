#include "drivers/files/tdms_reader.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/files/file_playing.hpp"
#include "tests/unit/drivers/files/tdms_bytes.hpp"

namespace dyncal::drivers::files {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t epoch_s = 2'082'844'800; // from 1904 to 1970

struct Played {
  SourceDescription description;
  CollectingSink sink;
};

Played play(const std::string& bytes, FileSettings settings = {}) {
  const TemporaryFile file("made.tdms", bytes);
  settings.path = file.path();
  FileSource source(settings);
  Played played;
  const auto description = source.describe();
  EXPECT_TRUE(description) << (description ? "" : description.error().message);
  if (description) {
    played.description = *description;
    const auto done = source.run(played.sink);
    EXPECT_TRUE(done) << (done ? "" : done.error().message);
  }
  return played;
}

std::string problem_with(const std::string& bytes, FileSettings settings = {}) {
  const TemporaryFile file("wrong.tdms", bytes);
  settings.path = file.path();
  return problem_of(settings);
}

// Two channels of one group: a of int16, b of f64, both at 1 kHz.
TdmsBytes two_channels(bool big_endian, std::uint64_t values) {
  TdmsBytes bytes(big_endian);
  bytes.add(std::uint32_t{3}).text("/'g'").add(~std::uint32_t{0}).add(std::uint32_t{0});
  bytes.text("/'g'/'a'").index(2, values).add(std::uint32_t{3});
  bytes.property("wf_increment", 0.001).time("wf_start_time", epoch_s + 5, std::uint64_t{1} << 63U);
  bytes.property("unit_string", "V");
  bytes.text("/'g'/'b'").index(10, values).add(std::uint32_t{0});
  return bytes;
}

std::string contiguous(bool big_endian, int first, int values) {
  TdmsBytes bytes(big_endian);
  for (int i = 0; i < values; ++i) {
    bytes.add(static_cast<std::int16_t>(first + i));
  }
  for (int i = 0; i < values; ++i) {
    bytes.add(0.5 * (first + i));
  }
  return bytes.bytes();
}

TEST(TdmsReader, ReadsEitherByteOrder) {
  for (const bool big_endian : {false, true}) {
    const std::uint32_t order = big_endian ? tdms_big_endian : 0;
    const auto played = play(tdms_segment(tdms_whole | order, two_channels(big_endian, 3).bytes(),
                                          contiguous(big_endian, 1, 3)));
    EXPECT_THAT(played.sink.channel(0), ElementsAre(1.0, 2.0, 3.0));
    EXPECT_THAT(played.sink.channel(1), ElementsAre(0.5, 1.0, 1.5));
    EXPECT_THAT(played.sink.stamps_ns, ElementsAre(5'500'000'000, 5'501'000'000, 5'502'000'000));
    ASSERT_EQ(played.description.channels.size(), 2U);
    EXPECT_EQ(played.description.channels[0].name, "a");
    EXPECT_EQ(played.description.channels[0].unit, "V");
    EXPECT_EQ(played.description.nominal_rate_hz, 1000.0);
  }
}

TEST(TdmsReader, GoesOnInChunksAndSegmentsWithoutMetadata) {
  const std::string file = tdms_segment(tdms_whole, two_channels(false, 2).bytes(),
                                        contiguous(false, 1, 2) + contiguous(false, 3, 2)) +
                           tdms_segment(tdms_raw_data, "", contiguous(false, 5, 2));
  const auto played = play(file);
  EXPECT_THAT(played.sink.channel(0), ElementsAre(1.0, 2.0, 3.0, 4.0, 5.0, 6.0));
  EXPECT_THAT(played.sink.channel(1), ElementsAre(0.5, 1.0, 1.5, 2.0, 2.5, 3.0));
}

TEST(TdmsReader, AmendsTheListOfObjects) {
  // In the second segment a has more values and b those of before, in the third only b has.
  TdmsBytes second;
  second.add(std::uint32_t{2}).text("/'g'/'a'").index(2, 1).add(std::uint32_t{1});
  second.property("note", "x");
  second.text("/'g'/'b'").index(10, 1).add(std::uint32_t{0});
  TdmsBytes third;
  third.add(std::uint32_t{1}).text("/'g'/'a'").add(~std::uint32_t{0}).add(std::uint32_t{0});
  const std::string file =
      tdms_segment(tdms_whole, two_channels(false, 2).bytes(), contiguous(false, 1, 2)) +
      tdms_segment(tdms_metadata | tdms_raw_data, second.bytes(), contiguous(false, 3, 1)) +
      tdms_segment(tdms_metadata | tdms_raw_data, third.bytes(), TdmsBytes().add(9.0).bytes());
  EXPECT_THAT(problem_with(file), HasSubstr("g/a and g/b do not have as many values (3 and 4)"));
  FileSettings settings;
  settings.channel = "g/a";
  EXPECT_THAT(play(file, settings).sink.channel(0), ElementsAre(1.0, 2.0, 3.0));
  settings.channel = "b";
  settings.sample_rate = sample_rate_from_hz(10.0);
  EXPECT_THAT(play(file, settings).sink.channel(0), ElementsAre(0.5, 1.0, 1.5, 9.0));
}

TEST(TdmsReader, ReadsRowsAndDropsAnIncompleteOneOfAnUnclosedSegment) {
  TdmsBytes rows;
  for (int i = 0; i < 3; ++i) {
    rows.add(static_cast<std::int16_t>(i)).add(0.25 * i);
  }
  const std::string metadata = two_channels(false, 3).bytes();
  const std::string whole = rows.bytes();
  EXPECT_THAT(play(tdms_segment(tdms_whole | tdms_interleaved, metadata, whole)).sink.channel(1),
              ElementsAre(0.0, 0.25, 0.5));
  for (std::size_t cut = 21; cut < 30; ++cut) {
    const auto played =
        play(tdms_segment(tdms_whole | tdms_interleaved, metadata, whole.substr(0, cut), false));
    EXPECT_THAT(played.sink.channel(0), ElementsAre(0.0, 1.0)) << cut;
  }
  EXPECT_THAT(
      problem_with(tdms_segment(tdms_whole | tdms_interleaved, metadata, whole.substr(0, 25))),
      HasSubstr("wrong.tdms: the segment at byte 0 has raw data that end within a row"));
  // Contiguous: b has only one of its values.
  const std::string cut = contiguous(false, 1, 3).substr(0, 6 + 8 + 5);
  EXPECT_THAT(play(tdms_segment(tdms_whole, metadata, cut, false)).sink.channel(0),
              ElementsAre(1.0));
}

std::string daqmx_object(const std::string& path, std::uint32_t kind,
                         const std::vector<std::array<std::uint32_t, 4>>& scalers,
                         const std::vector<std::uint32_t>& widths, std::uint64_t rows,
                         bool big_endian) {
  TdmsBytes bytes(big_endian);
  bytes.text(path).add(kind).add(~std::uint32_t{0}).add(std::uint32_t{1}).add(rows);
  bytes.add(static_cast<std::uint32_t>(scalers.size()));
  for (const auto& [type, buffer, place, id] : scalers) {
    bytes.add(type).add(buffer).add(place);
    kind == 0x126A ? bytes.raw(std::string(1, '\0')) : bytes.add(std::uint32_t{0});
    bytes.add(id);
  }
  bytes.add(static_cast<std::uint32_t>(widths.size()));
  for (const std::uint32_t width : widths) {
    bytes.add(width);
  }
  return bytes.bytes();
}

TEST(TdmsReader, ScalesTheRawDataOfDaqmx) {
  for (const bool big_endian : {false, true}) {
    // Two buffers; in the first int16 and a digital line, in the second u32 with scaler 1.
    TdmsBytes metadata(big_endian);
    metadata.add(std::uint32_t{3});
    metadata.raw(daqmx_object("/'g'/'a'", 0x1269, {{3, 0, 0, 0}}, {3, 4}, 2, big_endian));
    metadata.add(std::uint32_t{6});
    metadata.property("wf_increment", 0.5).property("NI_Number_Of_Scales", 2U);
    metadata.property("NI_Scale[1]_Scale_Type", "Linear");
    metadata.property("NI_Scale[1]_Linear_Slope", 0.5);
    metadata.property("NI_Scale[1]_Linear_Y_Intercept", 10.0);
    metadata.property("NI_Scale[1]_Linear_Input_Source", 0U);
    metadata.raw(daqmx_object("/'g'/'line'", 0x126A, {{0, 0, 21, 0}}, {3, 4}, 2, big_endian));
    metadata.add(std::uint32_t{1}).property("NI_Number_Of_Scales", 1U);
    metadata.raw(daqmx_object("/'g'/'b'", 0x1269, {{4, 1, 0, 1}}, {3, 4}, 2, big_endian));
    metadata.add(std::uint32_t{7});
    metadata.property("NI_Number_Of_Scales", 3U);
    metadata.property("NI_Scale[2]_Scale_Type", "Polynomial");
    metadata.property("NI_Scale[2]_Polynomial_Coefficients_Size", 3U);
    metadata.property("NI_Scale[2]_Polynomial_Coefficients[0]", 1.0);
    metadata.property("NI_Scale[2]_Polynomial_Coefficients[1]", 0.0);
    metadata.property("NI_Scale[2]_Polynomial_Coefficients[2]", 2.0);
    metadata.property("NI_Scale[2]_Polynomial_Input_Source", 1U);
    TdmsBytes data(big_endian);
    data.add(std::int16_t{-4}).raw("\x20").add(std::int16_t{6}).raw(std::string_view("\x00", 1));
    data.add(std::uint32_t{3}).add(std::uint32_t{5});
    const std::uint32_t order = big_endian ? tdms_big_endian : 0;
    const auto played =
        play(tdms_segment(tdms_whole | tdms_daqmx | order, metadata.bytes(), data.bytes()));
    EXPECT_THAT(played.sink.channel(0), ElementsAre(8.0, 13.0));
    EXPECT_THAT(played.sink.channel(1), ElementsAre(1.0, 0.0));
    EXPECT_THAT(played.sink.channel(2), ElementsAre(19.0, 51.0));
  }
}

TEST(TdmsReader, PassesOverTextsAndTimes) {
  TdmsBytes metadata;
  metadata.add(std::uint32_t{3});
  metadata.text("/'g'/'note'")
      .add(std::uint32_t{28})
      .add(std::uint32_t{0x20})
      .add(std::uint32_t{1});
  metadata.add(std::uint64_t{2}).add(std::uint64_t{11}).add(std::uint32_t{0});
  metadata.text("/'g'/'time'").index(0x44, 2).add(std::uint32_t{0});
  metadata.text("/'g'/'a''b'").index(9, 2).add(std::uint32_t{1}).property("wf_increment", 1.0);
  TdmsBytes data;
  data.add(std::uint32_t{1}).add(std::uint32_t{3}).raw("abc").raw(std::string(32, 'x'));
  data.add(1.5F).add(2.5F);
  const auto played = play(tdms_segment(tdms_whole, metadata.bytes(), data.bytes()));
  ASSERT_EQ(played.description.channels.size(), 1U);
  EXPECT_EQ(played.description.channels[0].name, "a'b");
  EXPECT_THAT(played.sink.channel(0), ElementsAre(1.5, 2.5));
}

TEST(TdmsReader, ReadsComplexNumbersAsTwoChannels) {
  TdmsBytes metadata;
  metadata.add(std::uint32_t{1}).text("/'g'/'z'").index(0x08000C, 2).add(std::uint32_t{1});
  metadata.property("wf_increment", 1.0);
  TdmsBytes data;
  data.add(1.0F).add(2.0F).add(3.0F).add(4.0F);
  const auto played = play(tdms_segment(tdms_whole, metadata.bytes(), data.bytes()));
  ASSERT_EQ(played.description.channels.size(), 2U);
  EXPECT_EQ(played.description.channels[1].name, "z_q");
  EXPECT_THAT(played.sink.channel(0), ElementsAre(1.0, 3.0));
  EXPECT_THAT(played.sink.channel(1), ElementsAre(2.0, 4.0));
}

std::string one_channel(const std::string& properties, std::uint32_t count,
                        const std::string& path = "/'g'/'a'") {
  TdmsBytes bytes;
  bytes.add(std::uint32_t{1}).text(path).index(1, 2).add(count).raw(properties);
  return bytes.bytes();
}

TEST(TdmsReader, TakesARateNearAWholeNumberAndAnyOtherExactly) {
  const std::pair<double, std::array<std::int64_t, 2>> cases[] = {
      {1.0 / 51'200.0, {1'000'000'000, 51'200}},
      {0.00099696, {996'960, 1}},
      {1.0 / 3.0, {1'000'000'000, 3}},
      {1.2345678901234568e-5, {1'543'209'862'654'321, 125'000'000'000}}};
  for (const auto& [increment_s, fraction] : cases) {
    const std::string metadata =
        one_channel(TdmsBytes().property("wf_increment", increment_s).bytes(), 1);
    const auto played = play(tdms_segment(tdms_whole, metadata, "ab"));
    ASSERT_TRUE(played.sink.blocks[0].clock);
    EXPECT_EQ(played.sink.blocks[0].clock->interval_numerator_ns, fraction[0]) << increment_s;
    EXPECT_EQ(played.sink.blocks[0].clock->interval_denominator, fraction[1]) << increment_s;
  }
}

TEST(TdmsReader, RefusesASecondRecordingInTheFile) {
  const auto of_start = [](std::int64_t seconds) {
    return one_channel(TdmsBytes()
                           .property("wf_increment", 1.0)
                           .time("wf_start_time", epoch_s + seconds, 0)
                           .bytes(),
                       2);
  };
  const auto appended = [&](std::int64_t seconds) {
    return tdms_segment(tdms_whole, of_start(100), "ab") +
           tdms_segment(tdms_whole, of_start(seconds), "cd");
  };
  EXPECT_EQ(play(appended(100)).sink.stamps_ns.back(), 103'000'000'000); // stated again
  EXPECT_EQ(play(appended(102)).sink.stamps_ns.back(), 103'000'000'000); // as counted
  EXPECT_THAT(problem_with(appended(150)),
              HasSubstr("g/a states another start before value 2, 50.000000 s after the first"));
}

TEST(TdmsReader, SaysWhatIsWrongAndWhere) {
  const std::string interval = TdmsBytes().property("wf_increment", 1.0).bytes();
  const std::string good = tdms_segment(tdms_whole, one_channel(interval, 1), "ab");
  EXPECT_EQ(problem_with(good), "");
  EXPECT_THAT(problem_with("RIFFxxxxWAVE" + std::string(40, 'x')),
              HasSubstr("wrong.tdms: is not a TDMS file"));
  EXPECT_THAT(problem_with(good + good.substr(0, 20)),
              HasSubstr("the segment at byte " + std::to_string(good.size()) +
                        " is cut within its lead-in"));
  EXPECT_THAT(problem_with(good.substr(0, good.size() - 1)), HasSubstr("it is incomplete"));
  EXPECT_THAT(problem_with(good + std::string(40, 'x')), HasSubstr("does not begin with \"TDSm\""));
  EXPECT_THAT(problem_with(tdms_segment(tdms_whole, one_channel("", 0), "ab")),
              HasSubstr("state no interval (wf_increment), and no sample rate is given"));
  EXPECT_THAT(problem_with(tdms_segment(tdms_whole, one_channel(interval, 1, "/g"), "ab")),
              HasSubstr("an object \"/g\""));
  EXPECT_THAT(problem_with(tdms_segment(tdms_metadata | tdms_raw_data,
                                        TdmsBytes().add(std::uint32_t{0}).bytes(), "ab")),
              HasSubstr("raw data of no channel"));
  const std::string scaled = TdmsBytes()
                                 .property("wf_increment", 1.0)
                                 .property("NI_Number_Of_Scales", 1U)
                                 .property("NI_Scale[0]_Scale_Type", "Thermocouple")
                                 .bytes();
  EXPECT_THAT(problem_with(tdms_segment(tdms_whole, one_channel(scaled, 3), "ab")),
              HasSubstr("channel g/a has the scaling \"Thermocouple\""));
  FileSettings settings;
  settings.channel = "g/c";
  EXPECT_THAT(problem_with(good, settings), HasSubstr("no channel 'g/c'; the file has: g/a"));
}

TEST(TdmsReader, RefusesEveryFileThatIsCut) {
  const std::string good =
      tdms_segment(tdms_whole, two_channels(false, 2).bytes(), contiguous(false, 1, 2)) +
      tdms_segment(tdms_raw_data, "", contiguous(false, 5, 2));
  const std::size_t second = good.rfind("TDSm");
  for (std::size_t length = 0; length < good.size(); ++length) {
    if (length != second) { // a whole segment is a whole file
      EXPECT_THAT(problem_with(good.substr(0, length)), HasSubstr("wrong.tdms: ")) << length;
    }
  }
}

TEST(TdmsReader, TellsHowMuchIsRead) {
  const std::string interval = TdmsBytes().property("wf_increment", 1e-4).bytes();
  TdmsBytes metadata;
  metadata.add(std::uint32_t{1})
      .text("/'g'/'a'")
      .index(1, 10'000)
      .add(std::uint32_t{1})
      .raw(interval);
  const TemporaryFile file("share.tdms",
                           tdms_segment(tdms_whole, metadata.bytes(), std::string(10'000, 'a')));
  const std::vector<double> shares = shares_of(settings_for(file));
  expect_rising_to_one(shares);
  EXPECT_DOUBLE_EQ(shares[1], 0.4098);
}

} // namespace
} // namespace dyncal::drivers::files
