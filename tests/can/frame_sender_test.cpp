#include "drivers/can/bus/frame_sender.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/can/bus/socketcan_source.hpp"
#include "tests/can/kernel_can.hpp"

namespace dyncal::drivers::can {
namespace {

using ::testing::HasSubstr;
using tests::frames_of;
using tests::ip;
using tests::on;
using tests::read_until;
using tests::VirtualCan;

CanFrame frame(std::uint32_t id, std::uint8_t length) {
  CanFrame made;
  made.id = id;
  made.length = length;
  for (std::size_t i = 0; i < length; ++i) {
    made.data[i] = static_cast<std::uint8_t>(3 * i + 1);
  }
  return made;
}

TEST(FrameSender, SendsFramesOfEveryFormatAsTheyAre) {
  const VirtualCan link("vcan0");
  SocketCanSource source(on("vcan0"));
  ASSERT_TRUE(source.open({{0x123, 0x7FF, false}, {0x1ABCDEF, 0x1FFFFFFF, true}}));
  auto sender = FrameSender::open("vcan0");
  ASSERT_TRUE(sender) << sender.error().message;
  std::vector<CanFrame> all = {frame(0x123, 0), frame(0x123, 8), frame(0x1ABCDEF, 5),
                               frame(0x123, 64), frame(0x123, 12)};
  all[2].extended = true;
  all[3].fd = all[3].bit_rate_switch = true;
  all[4].fd = all[4].error_state_indicator = true;
  for (const CanFrame& one : all) {
    const auto sent = sender->send(one);
    ASSERT_TRUE(sent) << sent.error().message;
  }
  const auto received = frames_of(
      read_until(source, [&](const auto& events) { return events.size() >= all.size(); }));
  ASSERT_EQ(received.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(received[i].id, all[i].id) << i;
    EXPECT_EQ(received[i].extended, all[i].extended) << i;
    EXPECT_EQ(received[i].fd, all[i].fd) << i;
    EXPECT_EQ(received[i].bit_rate_switch, all[i].bit_rate_switch) << i;
    EXPECT_EQ(received[i].error_state_indicator, all[i].error_state_indicator) << i;
    EXPECT_EQ(received[i].length, all[i].length) << i;
    EXPECT_EQ(received[i].data, all[i].data) << i;
  }
}

TEST(FrameSender, ReceivesNothingItself) {
  const VirtualCan link("vcan0");
  auto listener = FrameSender::open("vcan0");
  auto sender = FrameSender::open("vcan0");
  ASSERT_TRUE(listener);
  ASSERT_TRUE(sender);
  // Far more than a socket's buffer holds: nothing piles up.
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(sender->send(frame(0x123, 8))) << i;
  }
}

TEST(FrameSender, SaysInOneLineWhyItCannotSend) {
  const auto missing = FrameSender::open("can7");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message,
              HasSubstr("there is no interface 'can7'; 'ip link add can7 type vcan'"));
  const auto other = FrameSender::open("lo");
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("interface 'lo' is not a CAN interface"));

  const VirtualCan link("vcan0");
  auto sender = FrameSender::open("vcan0");
  ASSERT_TRUE(sender);
  ip("set vcan0 down");
  const auto down = sender->send(frame(0x123, 8));
  ASSERT_FALSE(down);
  EXPECT_THAT(down.error().message, HasSubstr("interface 'vcan0' does not accept the frame"));
  EXPECT_THAT(down.error().message, HasSubstr("is it up? 'ip link set vcan0 up'"));
  ip("set vcan0 mtu 16 up");
  CanFrame fd = frame(0x123, 64);
  fd.fd = true;
  const auto too_long = sender->send(fd);
  ASSERT_FALSE(too_long);
  EXPECT_THAT(too_long.error().message, HasSubstr("FD frames need 'ip link set vcan0 mtu 72'"));
  EXPECT_TRUE(sender->send(frame(0x123, 8))); // goes on with what the interface takes
}

} // namespace
} // namespace dyncal::drivers::can
