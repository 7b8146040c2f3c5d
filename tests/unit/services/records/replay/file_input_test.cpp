#include "services/records/replay/file_input.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline records {
namespace {

using testing::HasSubstr;

class FileInputTest : public testing::Test {
protected:
  // A file of 1 ms between its samples, one of them spoilt if asked for.
  SourceSettings settings(std::size_t samples, std::size_t spoilt_line = 0) const {
    const std::filesystem::path path = folder_.path() / "acs.csv";
    std::ofstream file(path);
    file << "t_ns,reference\n";
    for (std::size_t i = 0; i < samples; ++i) {
      file << i * 1'000'000 << ',' << (i + 2 == spoilt_line ? "what" : "1.5") << '\n';
    }
    SourceSettings source;
    source.name = "acs";
    source.where = "bench.toml:7";
    source.driver = FileSourceSettings{.path = path};
    return source;
  }

private:
  tests::TemporaryFolder folder_;
};

TEST_F(FileInputTest, GivesAllSamplesInOrderAndThenTheEnd) {
  const auto input = FileInput::open(settings(10'000));
  ASSERT_TRUE(input) << input.error().message;
  EXPECT_EQ((*input)->source(), "acs");
  ASSERT_EQ((*input)->description().channels.size(), 1U);
  std::uint64_t samples = 0;
  std::uint64_t blocks = 0;
  bool ended = false;
  while (!ended) {
    const auto block = (*input)->next();
    ASSERT_TRUE(block) << block.error().message;
    const SourceBlock view = (*input)->view(*block);
    EXPECT_EQ(view.number, blocks++);
    EXPECT_EQ(view.channels, 1U);
    if (view.samples > 0) {
      EXPECT_TRUE(view.is_consistent());
      EXPECT_EQ(view.first_sample, samples);
    }
    samples += view.samples;
    ended = view.end_of_stream;
  }
  EXPECT_EQ(samples, 10'000U);
  EXPECT_EQ((*input)->reached_ns(), 9'999'000'000);
}

TEST_F(FileInputTest, EndsItsThreadWhenNobodyTakesTheBlocks) {
  auto input = FileInput::open(settings(200'000));
  ASSERT_TRUE(input) << input.error().message;
  input->reset(); // would hang if the reader went on waiting for room
}

TEST_F(FileInputTest, NamesTheLineThatCannotBeRead) {
  const auto input = FileInput::open(settings(100, 50));
  std::string problem = input ? "" : input.error().message;
  while (input && problem.empty()) {
    const auto block = (*input)->next();
    ASSERT_FALSE(block && block->end_of_stream);
    problem = block ? "" : block.error().message;
  }
  EXPECT_THAT(problem, HasSubstr("source 'acs'"));
  EXPECT_THAT(problem, HasSubstr("50"));
}

TEST_F(FileInputTest, TakesALogOfCanFrames) {
  const tests::TemporaryFolder folder;
  folder.write("sensor.dbc", "BO_ 291 Sample: 8 S\n SG_ z : 0|16@1- (0.5,0) [0|0] \"m/s^2\" S\n"
                             " SG_ count : 16|16@1+ (1,0) [0|0] \"\" S\n");
  std::string log;
  for (int k = 0; k < 2000; ++k) { // frame 700 comes late, 900 is lost, then the sensor restarts
    const int sent = k == 700 ? 701 : k == 701 ? 700 : k;
    const int count = sent < 1500 ? sent : sent - 1500;
    if (k != 900) {
      char line[80];
      std::snprintf(line, sizeof(line), "(%d.%03d000) can0 123#0200%02X%02X00000000\n",
                    5 + k / 1000, k % 1000, count & 0xFF, count >> 8);
      log += line;
    }
  }
  SourceSettings source;
  source.name = "can";
  CanSourceSettings can;
  can.log = folder.write("drive.log", log);
  can.dbc = folder.path() / "sensor.dbc";
  can.messages = {"Sample"};
  can.counter = "count";
  can.nominal_rate_hz = 1000.0;
  can.bit_rates.nominal_per_s = 500e3;
  source.channels = {{"z", "acceleration"}};
  source.driver = can;
  const auto input = FileInput::open(source);
  ASSERT_TRUE(input) << input.error().message;
  ASSERT_EQ((*input)->description().channels.size(), 1U);
  EXPECT_EQ((*input)->description().channels[0].name, "acceleration");
  std::uint64_t samples = 0, next = 0;
  for (bool ended = false; !ended;) {
    const auto block = (*input)->next();
    ASSERT_TRUE(block) << block.error().message;
    const SourceBlock view = (*input)->view(*block);
    ended = view.end_of_stream;
    if (view.samples > 0) {
      EXPECT_GE(view.first_sample, next); // one session: numbers only rise
      next = view.first_sample + view.samples;
      EXPECT_EQ(view.values.front(), 1.0);
    }
    samples += view.samples;
  }
  EXPECT_EQ(samples, 1998U); // without the late and the lost one
  EXPECT_EQ(next, 2001U);    // and a gap of one where the sensor restarted
}

TEST_F(FileInputTest, RefusesALiveSource) {
  SourceSettings live = settings(1);
  live.driver = SocketSourceSettings{};
  const auto input = FileInput::open(live);
  ASSERT_FALSE(input);
  EXPECT_THAT(input.error().message,
              HasSubstr("bench.toml:7: source 'acs' is neither a file nor a CAN log"));
}

} // namespace
} // namespace dyncal::inline records
