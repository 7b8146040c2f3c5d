#include "drivers/files/file_source.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/files/file_playing.hpp"

namespace dyncal::drivers::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(FileSource, DescribesTheUncertaintyOfItsStampsThatIsStated) {
  const TemporaryFile file("two.csv", "t_ns,z\n0,1.0\n1000000,2.0\n");
  FileSettings settings = settings_for(file);
  for (const double u_stamp_s : {0.0, 2e-7}) {
    settings.u_stamp_s = u_stamp_s;
    FileSource source(settings);
    const auto description = source.describe();
    ASSERT_TRUE(description) << description.error().message;
    EXPECT_EQ(description->stamp_uncertainty_s, u_stamp_s);
  }
}

TEST(FileSource, PlaysARegularSeriesWithAClock) {
  std::string text = "t_ns,reference,sync\n";
  for (int i = 0; i < 10'000; ++i) {
    text += std::to_string(1'700'000'000'123'456'789LL + i * 50'000LL) + "," + std::to_string(i) +
            ".5,-" + std::to_string(i) + "e-3\n";
  }
  const TemporaryFile file("regular.csv", text);
  FileSource source(settings_for(file));
  const auto description = source.describe();
  ASSERT_TRUE(description) << description.error().message;
  ASSERT_EQ(description->channels.size(), 2U);
  EXPECT_EQ(description->channels[0].name, "reference");
  EXPECT_EQ(description->driver, "file");
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  ASSERT_EQ(sink.numbers.size(), 10'000U);
  EXPECT_EQ(sink.sessions_begun_at.size(), 1U);
  for (const SampleBlock& block : sink.blocks) {
    EXPECT_TRUE(block.clock);
    EXPECT_LE(block.samples, 4096U);
  }
  for (std::size_t i = 0; i < sink.numbers.size(); ++i) {
    ASSERT_EQ(sink.numbers[i], i);
    ASSERT_EQ(sink.stamps_ns[i],
              1'700'000'000'123'456'789LL + static_cast<std::int64_t>(i) * 50'000LL);
  }
  EXPECT_EQ(sink.channel(0)[9999], 9999.5);
  EXPECT_EQ(sink.channel(1)[20], -0.02);
  EXPECT_EQ(sink.counts.received, 10'000U);
  EXPECT_EQ(sink.counts.lost_in_device, 0U);
}

TEST(FileSource, KeepsEveryStampOfAnIrregularSeries) {
  const TemporaryFile file(
      "irregular.csv",
      "t_ns,z\n1700000000000000001,1\n1700000000000996961,2\n1700000000001993920,3\n");
  FileSource source(settings_for(file));
  ASSERT_TRUE(source.describe());
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  EXPECT_THAT(sink.stamps_ns,
              ElementsAre(1700000000000000001, 1700000000000996961, 1700000000001993920));
}

TEST(FileSource, TakesTheRateWhereThereIsNoTimeColumn) {
  const TemporaryFile file("rate.csv", "a;b\n1;2\n3;4\n5;6\n");
  FileSettings settings = settings_for(file);
  settings.sample_rate = sample_rate_from_hz(51200.0);
  FileSource source(settings);
  EXPECT_EQ(source.describe().value().nominal_rate_hz, 51200.0);
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  EXPECT_THAT(sink.stamps_ns, ElementsAre(0, 19531, 39063));
  EXPECT_THAT(sink.channel(1), ElementsAre(2.0, 4.0, 6.0));
}

TEST(FileSource, ShowsGapsOfTheSampleNumber) {
  const TemporaryFile file("gap.csv", "t_ns,sample_number,z\n0,7,1\n10,8,2\n30,10,3\n40,11,\n");
  FileSource source(settings_for(file));
  ASSERT_EQ(source.describe().value().channels.size(), 1U);
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  EXPECT_THAT(sink.numbers, ElementsAre(7, 8, 10, 11));
  EXPECT_THAT(sink.stamps_ns, ElementsAre(0, 10, 30, 40));
  ASSERT_EQ(sink.blocks.size(), 2U); // a lost sample ends a block
  EXPECT_TRUE(std::isnan(sink.channel(0)[3]));
}

TEST(FileSource, GivesChannelsTheNamesAndUnitsOfTheBenchFile) {
  const TemporaryFile file("names.csv", "t_ns,\"Data_11\",z\r\n0,1,2\r\n5,3,4\r\n");
  FileSettings settings = settings_for(file);
  settings.channels = {{"Data_11", "sync"}};
  settings.units = {{"sync", "\\volt"}};
  FileSource source(settings);
  const auto description = source.describe();
  ASSERT_TRUE(description) << description.error().message;
  EXPECT_EQ(description->channels[0].name, "sync");
  EXPECT_EQ(description->channels[0].unit, "\\volt");
  EXPECT_EQ(description->channels[1].name, "z");
}

TEST(FileSource, SaysWhichChannelIsMissing) {
  const TemporaryFile file("missing.csv", "t_ns,a,b\n0,1,2\n");
  FileSettings settings = settings_for(file);
  settings.channels = {{"c", "sync"}};
  EXPECT_THAT(problem_of(settings), HasSubstr("no channel 'c'; the file has: a, b"));
  settings.channels = {};
  settings.units = {{"d", "\\volt"}};
  EXPECT_THAT(problem_of(settings), HasSubstr("no channel 'd'"));
  settings.units = {};
  settings.channels = {{"a", "b"}};
  EXPECT_THAT(problem_of(settings), HasSubstr("two channels are called 'b'"));
}

TEST(FileSource, NamesTheLineOfWhatIsWrong) {
  const std::pair<const char*, const char*> cases[] = {
      {"", ":1: the file is empty"},
      {"1,2\n3,4\n", ":1: column 1 has no name"},
      {"t_ns,a,a\n0,1,2\n", ":1: two columns are called 'a'"},
      {"t_ns,a\n", "no samples below"},
      {"t_ns,a\n0,1\n1,2\n2,x\n", ":4: 'x' in column a is not a number"},
      {"t_ns,a\n0,1\n1.5,2\n", ":3: '1.5' in column t_ns is not a whole number"},
      {"t_ns,a\n0,1\n1,2\n2\n", ":4: 1 fields, but the first line has 2 columns"},
      {"t_ns,a\n0,1\n1,2,3\n", ":3: more fields than"},
      {"t_ns,sample_number,a\n0,5,1\n1,5,2\n", ":3: sample_number 5 after 5"},
  };
  for (const auto& [text, message] : cases) {
    const TemporaryFile file("wrong.csv", text);
    EXPECT_THAT(problem_of(settings_for(file)), HasSubstr(message)) << text;
  }
}

TEST(FileSource, FlagsCountsAndGoesOnWhenAStampDoesNotRise) {
  const TemporaryFile file("disorder.csv", "t_ns,a\n0,1\n10,2\n10,3\n7,4\n40,5\n50,6\n");
  FileSource source(settings_for(file));
  ASSERT_TRUE(source.describe());
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  EXPECT_EQ(sink.numbers.size(), 6U);
  EXPECT_EQ(sink.counts.stamps_not_trusted, 2U);
  std::vector<std::uint8_t> flags;
  for (const SampleBlock& block : sink.blocks) {
    std::vector<std::uint8_t> of_block = block.flags;
    of_block.resize(block.samples, 0);
    flags.insert(flags.end(), of_block.begin(), of_block.end());
  }
  EXPECT_EQ(flags, (std::vector<std::uint8_t>{0, 0, stamp_repeated, stamp_backwards, 0, 0}));
}

TEST(FileSource, SaysThatThereIsNoFileOrNoTime) {
  FileSettings settings;
  settings.path = "/nowhere/acs.csv";
  EXPECT_THAT(problem_of(settings), HasSubstr("/nowhere/acs.csv: cannot read this file"));
  const TemporaryFile file("untimed.csv", "a\n1\n");
  EXPECT_THAT(problem_of(settings_for(file)),
              HasSubstr(":1: names no column t_ns, and no sample rate is given"));
}

TEST(FileSource, KeepsThePaceItIsAskedFor) {
  std::string text = "t_ns,a\n";
  for (int i = 0; i < 2000; ++i) {
    text += std::to_string(i * 1'000'000LL) + ",1\n"; // two seconds
  }
  const TemporaryFile file("paced.csv", text);
  FileSettings settings = settings_for(file);
  settings.speed = 10.0;
  FileSource source(settings);
  ASSERT_TRUE(source.describe());
  CollectingSink sink;
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_TRUE(source.run(sink));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(199));
  EXPECT_EQ(sink.numbers.size(), 2000U);
  EXPECT_LE(sink.blocks[1].samples, 500U); // 50 ms of the player's time
}

TEST(FileSource, StopsInTheMiddleWhenAskedTo) {
  std::string text = "t_ns,a\n";
  for (int i = 0; i < 100; ++i) {
    text += std::to_string(i * 1'000'000'000LL) + ",1\n";
  }
  const TemporaryFile file("stopped.csv", text);
  FileSettings settings = settings_for(file);
  settings.speed = 1.0;
  FileSource source(settings);
  ASSERT_TRUE(source.describe());
  CollectingSink sink;
  sink.after_block = [&] { source.stop(); };
  ASSERT_TRUE(source.run(sink));
  EXPECT_LT(sink.numbers.size(), 5U);
}

TEST(FileSource, NamesWhatIsNoText) {
  const auto problem = [](const char* name, const std::string& bytes) {
    const TemporaryFile file(name, bytes);
    return problem_of(settings_for(file));
  };
  EXPECT_THAT(problem("a.npz", std::string("PK\x03\x04\x14\x00", 6)),
              testing::HasSubstr("a.npz: is an archive (NPZ"));
  EXPECT_THAT(problem("a.csv", "\x93NUMPY..."), testing::HasSubstr("must end in .npy"));
  EXPECT_THAT(problem("a.mat", std::string("MATLAB\x00\x01", 8)), testing::HasSubstr("is no text"));
}

} // namespace
} // namespace dyncal::drivers::files
