#include "drivers/virtual_bench/can/can_line.hpp"

#include <gtest/gtest.h>

#include "drivers/can/bus/socketcan_source.hpp"
#include "tests/can/kernel_can.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

using drivers::can::FrameSender;
using drivers::can::SocketCanSource;
using tests::CanFrame;
using tests::frames;
using tests::frames_of;
using tests::now_ns;
using tests::on;
using tests::read_until;

constexpr std::int64_t millisecond_ns = 1'000'000;

class Line : public testing::Test {
protected:
  void SetUp() override {
    const auto opened = source.open({{0, 0, false}});
    ASSERT_TRUE(opened) << opened.error().message;
    auto sender = FrameSender::open("vcan0");
    ASSERT_TRUE(sender) << sender.error().message;
    line.emplace(std::move(*sender));
  }

  static CanFrame numbered(int number) {
    CanFrame frame;
    frame.id = 0x100;
    frame.length = 1;
    frame.data[0] = static_cast<std::uint8_t>(number);
    return frame;
  }

  std::vector<CanFrame> receive(std::size_t wanted) {
    return frames_of(read_until(source, frames(wanted)));
  }

  const tests::VirtualCan link{"vcan0"};
  SocketCanSource source{on("vcan0")};
  std::optional<CanLine> line;
};

TEST_F(Line, PutsEveryFrameOnTheInterfaceNotBeforeItsEndAndInOrder) {
  const std::int64_t first_ns = now_ns() + 20 * millisecond_ns;
  constexpr int sent = 100;
  for (int i = 0; i < sent; ++i) {
    line->put(numbered(i), first_ns + i * 2 * millisecond_ns, i % 3 != 0);
  }
  const auto received = receive(sent);
  ASSERT_EQ(received.size(), std::size_t{sent});
  for (int i = 0; i < sent; ++i) {
    EXPECT_EQ(received[static_cast<std::size_t>(i)].data[0], i);
    EXPECT_GE(received[static_cast<std::size_t>(i)].kernel_ns, first_ns + i * 2 * millisecond_ns)
        << i;
  }
  EXPECT_EQ(line->sent(), std::uint64_t{sent});
  EXPECT_EQ(line->exact(), 66U);
  EXPECT_EQ(line->refused(), 0U);
}

TEST_F(Line, SendsAndCountsFramesOfWhichTheEndHasPassed) {
  line->put(numbered(1), now_ns() - millisecond_ns, true);
  line->put(numbered(2), now_ns() - millisecond_ns, false);
  EXPECT_EQ(receive(2).size(), 2U);
  EXPECT_EQ(line->exact(), 1U);
  EXPECT_EQ(line->late(), 1U); // of those whose stamp matters
}

TEST_F(Line, CountsFramesThatTheInterfaceDoesNotTakeAndGoesOn) {
  tests::ip("set vcan0 down");
  line->put(numbered(1), now_ns(), true);
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  std::vector<tests::BusEvent> events;
  while (line->refused() == 0 && std::chrono::steady_clock::now() < deadline) {
    ASSERT_TRUE(source.read(events, std::chrono::milliseconds(10)));
  }
  EXPECT_EQ(line->refused(), 1U);
  tests::ip("set vcan0 up");
  line->put(numbered(2), now_ns(), true);
  const auto received = receive(1);
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].data[0], 2);
  EXPECT_EQ(line->sent(), 1U);
}

TEST_F(Line, EndsAtOnceWithoutSendingWhatIsStillToCome) {
  line->put(numbered(1), now_ns() + 50 * millisecond_ns, true);
  line->put(numbered(2), now_ns() + 100'000 * millisecond_ns, true);
  ASSERT_EQ(receive(1).size(), 1U);
  const auto before = std::chrono::steady_clock::now();
  line.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(50));
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
