#include "drivers/files/dump_reader.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/files/file_playing.hpp"

namespace dyncal::drivers::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string description =
    R"({"Name": "MPU 9250", "ID": 535035904, )"
    R"("1": {"CHID": 1, "PHYSICAL_QUANTITY": "X", "UNIT": "\\metre", "RESOLUTION": 4.0, )"
    R"("MIN_SCALE": -1.0, "MAX_SCALE": 1.0, "HIERARCHY": "Acceleration/0"}, )"
    R"("2": {"PHYSICAL_QUANTITY": "Y", "UNIT": "\\metre", "HIERARCHY": "Acceleration/1"}, )"
    R"("3": {"PHYSICAL_QUANTITY": "Z", "UNIT": "\\metre", "HIERARCHY": "Acceleration/2"}, )"
    R"("10": {"PHYSICAL_QUANTITY": "T", "UNIT": "\\degreecelsius", "HIERARCHY": "Temperature/0"}})"
    "\n";
const std::string names = "id;sample_number;unix_time;unix_time_nsecs;time_uncertainty;Data_01;"
                          "Data_02;Data_03;Data_04;Data_05;Data_06;Data_07;Data_08;Data_09;Data_10;"
                          "Data_11;Data_12;Data_13;Data_14;Data_15;Data_16\n";

// The last columns: Data_10 is the temperature, Data_11 sync.
std::string row(std::uint64_t number, const std::string& time, const std::string& x) {
  return "535035904;" + std::to_string(number) + ";" + time + ";" + x +
         ";0.5;-1.0;0.0;0.0;0.0;0.0;0.0;0.0;25.0;-0.25;0.0;0.0;0.0;0.0;0.0\n";
}

std::string problem_with(const std::string& text) {
  const TemporaryFile file("wrong.dump", text);
  return problem_of(settings_for(file));
}

TEST(DumpReader, PlaysWhatTheReceiverWrote) {
  const TemporaryFile file("a.dump", description + names +
                                         row(7, "1602502355;47941016;40000000", "20.125") +
                                         row(8, "1602502355;48941016;6", "1e-3") +
                                         row(11, "1602502355;51941016;0", "3.0"));
  FileSettings settings = settings_for(file);
  settings.channels = {{"Data_11", "sync"}};
  settings.units = {{"sync", "\\volt"}};
  FileSource source(settings);
  const auto described = source.describe();
  ASSERT_TRUE(described) << described.error().message;
  std::vector<std::string> channels;
  for (const auto& channel : described->channels) {
    channels.push_back(channel.name + " " + channel.unit);
  }
  EXPECT_THAT(channels,
              ElementsAre("acceleration_x \\metre", "acceleration_y \\metre",
                          "acceleration_z \\metre", "temperature \\degreecelsius", "sync \\volt"));
  EXPECT_EQ(described->device, "MPU 9250");
  EXPECT_EQ(described->channels[0].resolution, 0.5);
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  ASSERT_EQ(sink.blocks.size(), 2U);
  EXPECT_EQ(sink.blocks[0].first_sample, 7U);
  EXPECT_EQ(sink.blocks[1].first_sample, 11U); // the gap
  EXPECT_THAT(sink.blocks[0].values,
              ElementsAre(20.125, 1e-3, 0.5, 0.5, -1.0, -1.0, 25.0, 25.0, -0.25, -0.25));
  EXPECT_EQ(sink.blocks[0].clock->stamp_ns(7), 1602502355047941016);
  EXPECT_THAT(sink.blocks[0].stamp_uncertainty_ns, ElementsAre(10000000, 2));
  EXPECT_THAT(sink.blocks[1].flags, ElementsAre(stamp_no_uncertainty));
}

TEST(DumpReader, CountsSampleNumbersOnAndTakesTheTicks) {
  const std::string last = row(4294967295U, "1602502355;1;4", "1.0");
  const std::string next = row(0, "1602502355;1001;4", "2.0");
  const TemporaryFile file("b.dump", description + names + last.substr(0, last.size() - 1) +
                                         ";123456\n" + next);
  FileSource source(settings_for(file));
  ASSERT_TRUE(source.describe());
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  ASSERT_EQ(sink.blocks.size(), 1U);
  EXPECT_EQ(sink.blocks[0].first_sample, 4294967295U);
  EXPECT_EQ(sink.blocks[0].samples, 2U);
}

TEST(DumpReader, NamesTheLineThatIsWrong) {
  const std::string good = row(7, "1602502355;1;4", "1.0");
  EXPECT_THAT(problem_with("t_ns,a\n1,2\n"), HasSubstr("wrong.dump:1: a dump of the SmartUp"));
  EXPECT_THAT(problem_with(""), HasSubstr(":1: "));
  EXPECT_THAT(problem_with(description), HasSubstr(":2: must name the columns"));
  EXPECT_THAT(problem_with(description + names), HasSubstr("no samples"));
  EXPECT_THAT(problem_with(description + names + good + good), HasSubstr(":4: sample_number 7"));
  EXPECT_THAT(problem_with(description + names + "1;x\n"), HasSubstr(":3: the first 5 fields"));
  EXPECT_THAT(problem_with(description + names + good.substr(0, 40)),
              HasSubstr(":3: field Data_0"));
  EXPECT_THAT(problem_with(description + names + good + "9" + row(8, "1602502355;9;4", "1.0")),
              HasSubstr(":4: is of another sensor"));
  EXPECT_THAT(problem_with(description + names + row(7, "1602502355;1000000000;4", "1.0")),
              HasSubstr(":3: sample number or time is out of range"));
}

TEST(DumpReader, TellsHowMuchIsRead) {
  std::string text = description + names;
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    text += row(i, "1602502355;" + std::to_string(1000 * i) + ";40", "1.0");
  }
  const TemporaryFile file("share.dump", text);
  const std::vector<double> shares = shares_of(settings_for(file));
  expect_rising_to_one(shares);
  EXPECT_NEAR(shares[1], 0.41, 0.02);
}

} // namespace
} // namespace dyncal::drivers::files
