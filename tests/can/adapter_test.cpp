// Interfaces with a controller's states: the kernel's serial adapters (slcan, on can-dev), and two
// interfaces on one bus (vxcan).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include "drivers/can/bus/socketcan_source.hpp"
#include "tests/can/serial_adapter.hpp"

namespace dyncal::drivers::can {
namespace {

using ::testing::HasSubstr;
using tests::frames;
using tests::frames_of;
using tests::ip;
using tests::on;
using tests::read_until;
using tests::says;
using tests::Sender;
using tests::SerialAdapter;
using tests::told;

const std::vector<FrameFilter> sensor_only = {{0x123, 0x7FF, false}};

TEST(SerialCan, ReceivesFramesAndKnowsTheBitRate) {
  SerialAdapter adapter;
  SocketCanSource source(on(adapter.name()));
  const auto link = source.open(sensor_only);
  ASSERT_TRUE(link) << link.error().message;
  EXPECT_EQ(link->bit_rate_per_s, 500'000U);
  EXPECT_EQ(link->kind, "can");
  EXPECT_EQ(link->bus, BusState::error_active);
  adapter.say("t1233112233");
  adapter.say("t1242AABB");
  adapter.say("t12310F");
  const auto received = frames_of(read_until(source, frames(2)));
  ASSERT_EQ(received.size(), 2U);
  EXPECT_EQ(received[0].length, 3);
  EXPECT_EQ(received[0].data[2], 0x33);
  EXPECT_EQ(received[1].data[0], 0x0F);
  EXPECT_GT(received[0].kernel_ns, 0);
  EXPECT_FALSE(received[0].sent_here);
}

TEST(SerialCan, RefusesAnInterfaceThatRunsAtAnotherBitRate) {
  const SerialAdapter adapter;
  SocketCanSettings settings = on(adapter.name());
  settings.bit_rate_per_s = 250'000;
  const auto link = SocketCanSource(settings).open(sensor_only);
  ASSERT_FALSE(link);
  EXPECT_THAT(link.error().message, HasSubstr(adapter.name()));
  EXPECT_THAT(link.error().message, HasSubstr("500000"));
  EXPECT_THAT(link.error().message, HasSubstr("250000"));
}

TEST(SerialCan, TellsStatesCountersAndFaultsOfTheController) {
  SerialAdapter adapter;
  SocketCanSource source(on(adapter.name()));
  ASSERT_TRUE(source.open(sensor_only));
  adapter.say("sw096100"); // warning, receive errors 96, transmit errors 100
  adapter.say("sp128130"); // passive
  adapter.say("e1o");      // the controller's buffer overran
  const auto events = read_until(source, says("overrun"));
  ASSERT_TRUE(says("overrun")(events)) << told(events);
  BusState worst = BusState::unknown;
  bool counters = false;
  bool frames_lost = false;
  for (const BusEvent& event : events) {
    if (const auto* fault = std::get_if<BusFault>(&event)) {
      worst = fault->state == BusState::error_passive ? fault->state : worst;
      counters = counters || (fault->transmit_errors == 130 && fault->receive_errors == 128);
      frames_lost = frames_lost || fault->frames_lost;
    }
  }
  EXPECT_EQ(worst, BusState::error_passive);
  EXPECT_TRUE(counters);
  EXPECT_TRUE(frames_lost);
}

TEST(SerialCan, IsRestartedAfterBusOffWhereThatIsAskedFor) {
  SerialAdapter adapter;
  SocketCanSettings settings = on(adapter.name());
  settings.restart_after_bus_off = std::chrono::milliseconds(100);
  SocketCanSource source(settings);
  ASSERT_TRUE(source.open(sensor_only));
  adapter.say("sb255255");
  // This driver cannot restart its controller; the interface is set down and up.
  const auto events = read_until(source, says("set down and up after bus-off"));
  ASSERT_TRUE(says("set down and up after bus-off")(events)) << told(events);
  EXPECT_TRUE(says("bus-off")(events));
  EXPECT_THAT(adapter.heard(), HasSubstr("O\r")); // opened again
  adapter.say("t12310F");
  EXPECT_EQ(frames_of(read_until(source, frames(1))).size(), 1U);
}

TEST(SerialCan, SaysWhichRightARestartNeeds) {
  SerialAdapter adapter;
  SocketCanSettings settings = on(adapter.name());
  settings.restart_after_bus_off = std::chrono::milliseconds(50);
  SocketCanSource source(settings);
  ASSERT_EQ(::seteuid(65534), 0); // nobody: receiving needs no right
  const auto link = source.open(sensor_only);
  adapter.say("sb255255");
  const auto events = read_until(source, says("CAP_NET_ADMIN"));
  ASSERT_EQ(::seteuid(0), 0);
  ASSERT_TRUE(link) << link.error().message;
  EXPECT_TRUE(says("it needs CAP_NET_ADMIN")(events)) << told(events);
}

TEST(SerialCan, NoticesThatTheAdapterWasPulledOut) {
  SerialAdapter adapter;
  SocketCanSource source(on(adapter.name()));
  ASSERT_TRUE(source.open(sensor_only));
  adapter.unplug();
  const auto events = read_until(source, says("has gone"));
  ASSERT_TRUE(says("has gone")(events)) << told(events);
  EXPECT_TRUE(std::get<LinkChange>(events.back()).interrupted);
  EXPECT_FALSE(std::get<LinkChange>(events.back()).link.present);
}

TEST(TwoInterfacesOnOneBus, HearEachOtherAndTellWhoSent) {
  ip("add vx0 type vxcan peer name vx1");
  ip("set vx0 mtu 72 up");
  ip("set vx1 mtu 72 up");
  {
    SocketCanSource source(on("vx0"));
    ASSERT_TRUE(source.open(sensor_only));
    ASSERT_TRUE(Sender("vx1").send(0x123, {7}));
    ASSERT_TRUE(Sender("vx0").send(0x123, {8}));
    ASSERT_TRUE(Sender("vx1").send(0x123, std::vector<std::uint8_t>(64, 9), true));
    const auto received = frames_of(read_until(source, frames(3)));
    ASSERT_EQ(received.size(), 3U);
    EXPECT_FALSE(received[0].sent_here);
    EXPECT_TRUE(received[1].sent_here);
    EXPECT_TRUE(received[2].fd);
    ip("set vx1 down"); // the other end of the cable
    const auto events = read_until(source, says("lost its bus"));
    EXPECT_TRUE(says("lost its bus")(events)) << told(events);
    ip("set vx1 up");
    EXPECT_TRUE(says("has its bus back")(read_until(source, says("has its bus back"))));
    ASSERT_TRUE(Sender("vx1").send(0x123, {7}));
    EXPECT_EQ(frames_of(read_until(source, frames(1))).size(), 1U);
  }
  ip("del vx0");
}

} // namespace
} // namespace dyncal::drivers::can
