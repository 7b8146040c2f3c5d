#include "services/stream/write_pace.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline stream {
namespace {

using namespace std::chrono_literals;

class WritePaceTest : public testing::Test {
protected:
  // Writes until it has to wait.
  int write_on(int at_most = 1000, std::size_t bytes = 10) {
    int written = 0;
    while (written < at_most && pace_.may_write(now_, [this] { return acknowledged_; })) {
      pace_.wrote(bytes);
      ++written;
    }
    return written;
  }

  WritePace pace_{{.messages = 50, .bytes = 10'000}, 1s};
  WritePace::Instant now_{std::chrono::hours(1)};
  bool acknowledged_ = false;
};

TEST_F(WritePaceTest, StopsAfterAWindowUntilAllIsAcknowledged) {
  EXPECT_EQ(write_on(), 50);
  now_ += 900ms;
  EXPECT_EQ(write_on(), 0);
  acknowledged_ = true;
  EXPECT_EQ(write_on(1), 1);
  acknowledged_ = false;
  EXPECT_EQ(write_on(), 49);
}

TEST_F(WritePaceTest, AWindowIsFullOfBytesAsWell) {
  EXPECT_EQ(write_on(1000, 1000), 10);
}

TEST_F(WritePaceTest, NeverWaitsWhileEverybodyKeepsUp) {
  acknowledged_ = true;
  EXPECT_EQ(write_on(1000), 1000);
}

TEST_F(WritePaceTest, WaitsForAReaderThatHangsOnceAndNoLonger) {
  EXPECT_EQ(write_on(), 50);
  now_ += 500ms;
  EXPECT_EQ(write_on(), 0);
  now_ += 501ms;
  EXPECT_FALSE(pace_.hanging());
  write_on(1);
  now_ += 1000ms;
  EXPECT_EQ(write_on(1000), 1000);
  EXPECT_TRUE(pace_.hanging());
  acknowledged_ = true;
  write_on(51);
  acknowledged_ = false;
  EXPECT_FALSE(pace_.hanging());
  EXPECT_LT(write_on(), 50);
}

} // namespace
} // namespace dyncal::inline stream
