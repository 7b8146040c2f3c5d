#include "drivers/can/bus/log_source.hpp"

#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::drivers::can {
namespace {

using ::testing::HasSubstr;

const std::vector<FrameFilter> sensor_only = {{0x123, 0x7FF, false}};

class Log : public testing::Test {
protected:
  std::filesystem::path write(const std::string& text) const {
    return folder.write("drive.log", text);
  }

  const tests::TemporaryFolder folder;
};

TEST_F(Log, GivesTheFramesOfItsInterfaceInOrderAndEnds) {
  LogSource source(write("(5.000000) can0 123#01\n(5.000100) can1 123#02\n(5.000200) can0 "
                         "124#03\n(1000005.0003) can0 123#04\n"),
                   "can0", 0.0);
  const auto link = source.open(sensor_only);
  ASSERT_TRUE(link) << link.error().message;
  EXPECT_TRUE(link->up);
  EXPECT_EQ(link->bit_rate_per_s, 0U);
  std::vector<BusEvent> events;
  while (source.read(events, std::chrono::milliseconds(10)).value() == ReadState::more) {
  }
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(std::get<CanFrame>(events[0]).data[0], 1);
  EXPECT_EQ(std::get<CanFrame>(events[0]).kernel_ns, 5'000'000'000);
  EXPECT_EQ(std::get<CanFrame>(events[1]).data[0], 4);
}

TEST_F(Log, PassesOverErrorFramesAndOddLines) {
  std::string text;
  for (int k = 0; k < 300; ++k) {
    text += "(5." + std::to_string(100'000 + k) + ") can0 123#01\n";
    text += k % 100 == 50 ? "(5.2) can0 20000004#0000100000000000\n" : "";
  }
  LogSource source(write(text + "candump: restarted\n(5.9) can0 123#02\n(6.0) can0 12"), "can0",
                   0.0);
  const auto link = source.open(sensor_only);
  ASSERT_TRUE(link) << link.error().message;
  std::vector<BusEvent> events;
  while (source.read(events, std::chrono::milliseconds(10)).value() == ReadState::more) {
  }
  ASSERT_EQ(events.size(), 302U);
  const auto* warning = std::get_if<LinkChange>(&events.front());
  ASSERT_NE(warning, nullptr);
  EXPECT_FALSE(warning->interrupted);
  EXPECT_THAT(warning->what, HasSubstr("1 lines are not of candump and are passed over, the first "
                                       "is line 304"));
}

TEST_F(Log, PutsALineThatWasWrittenLateInItsPlace) {
  LogSource source(write("(5.001) can0 123#01\n(5.003) can0 123#03\n(5.002) can0 123#02\n"
                         "(5.004) can0 123#04\n(2.001) can0 123#05\n(2.002) can0 123#06\n"),
                   "", 0.0);
  ASSERT_TRUE(source.open(sensor_only));
  std::vector<BusEvent> events;
  ASSERT_TRUE(source.read(events, std::chrono::milliseconds(10)));
  ASSERT_EQ(events.size(), 6U);
  for (std::size_t i = 0; i < events.size(); ++i) { // and a clock that was set back stays back
    EXPECT_EQ(std::get<CanFrame>(events[i]).data[0], i + 1);
  }
}

TEST_F(Log, ReadsWhatCandumpShowsOnTheScreen) {
  LogSource source(
      write(" (5.000000)  can0  123   [2]  01 AF\n"
            " (5.000100)  can0  TX B -  123   [3]  01 02 03   '...'\n"
            " (5.000200)  can0  123  [12]  00 01 02 03 04 05 06 07 08 09 0A 0B\n"
            " (5.000300)  can0  123   [0]  remote request\n"
            " (5.000400)  can0  20000080   [8]  00 00 00 00 00 00 00 00   ERRORFRAME\n"),
      "can0", 0.0);
  const auto link = source.open(sensor_only);
  ASSERT_TRUE(link) << link.error().message;
  std::vector<BusEvent> events;
  ASSERT_TRUE(source.read(events, std::chrono::milliseconds(10)));
  ASSERT_GE(events.size(), 3U);
  EXPECT_EQ(std::get<CanFrame>(events[0]).data[1], 0xAF);
  EXPECT_EQ(std::get<CanFrame>(events[1]).length, 3);
  EXPECT_TRUE(std::get<CanFrame>(events[2]).fd);
  EXPECT_EQ(std::get<CanFrame>(events[2]).data[11], 0x0B);
}

TEST_F(Log, WaitsForTheNextFrameUntilItIsStopped) {
  LogSource source(write("(5.000000) can0 123#01\n(1005.000000) can0 123#02\n"), "", 1.0);
  ASSERT_TRUE(source.open(sensor_only));
  std::vector<BusEvent> events;
  while (events.empty()) {
    EXPECT_EQ(source.read(events, std::chrono::milliseconds(10)).value(), ReadState::more);
  }
  std::jthread stopper([&] { source.stop(); });
  for (auto state = ReadState::more; state != ReadState::stopped;) {
    state = source.read(events, std::chrono::seconds(10)).value();
  }
  EXPECT_EQ(events.size(), 1U);
}

TEST_F(Log, SaysWhatIsWrongWithItInOneLine) {
  EXPECT_THAT(LogSource(write("(5.0) can0 124#01\n"), "", 0.0).open(sensor_only).error().message,
              HasSubstr("has none of the sensor's messages; check 'messages'"));
  EXPECT_THAT(
      LogSource(write("(5.0) can0 123#01\n"), "can7", 0.0).open(sensor_only).error().message,
      HasSubstr("on interface 'can7'"));
  EXPECT_THAT(
      LogSource(write("(5.0) can0 123#01\nrubbish\n"), "", 0.0).open(sensor_only).error().message,
      HasSubstr(".log:2"));
}

} // namespace
} // namespace dyncal::drivers::can
