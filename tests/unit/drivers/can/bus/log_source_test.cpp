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
