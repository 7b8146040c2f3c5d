#include "drivers/can/bus/socketcan_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <thread>

#include "tests/can/kernel_can.hpp"

namespace dyncal::drivers::can {
namespace {

using ::testing::HasSubstr;
using tests::frames;
using tests::frames_of;
using tests::ip;
using tests::now_ns;
using tests::on;
using tests::read_until;
using tests::says;
using tests::Sender;
using tests::VirtualCan;

const std::vector<FrameFilter> sensor_only = {{0x123, 0x7FF, false}};

std::string failure(SocketCanSource source) {
  const auto link = source.open(sensor_only);
  return link ? "opened" : link.error().message;
}

TEST(SocketCan, SaysInOneLineWhyAnInterfaceCannotBeUsed) {
  EXPECT_THAT(
      failure(SocketCanSource(on("can7"))),
      HasSubstr("there is no interface 'can7'; 'ip link' lists the interfaces of this machine"));
  const VirtualCan link("vcan0");
  ip("set vcan0 down");
  EXPECT_THAT(failure(SocketCanSource(on("vcan0"))),
              HasSubstr("interface 'vcan0' is down; 'ip link set vcan0 up'"));
  EXPECT_THAT(failure(SocketCanSource(on("lo"))),
              HasSubstr("interface 'lo' is not a CAN interface"));
}

TEST(SocketCan, ReceivesClassicAndFdFramesWithTheKernelsStamp) {
  const VirtualCan link("vcan0");
  SocketCanSource source(on("vcan0"));
  ASSERT_TRUE(source.open({{0x123, 0x7FF, false}, {0x1ABCDEF, 0x1FFFFFFF, true}}));
  Sender sender("vcan0");
  const std::int64_t before_ns = now_ns();
  ASSERT_TRUE(sender.send(0x123, {1, 2, 3}));
  ASSERT_TRUE(sender.send(0x1ABCDEF | CAN_EFF_FLAG, std::vector<std::uint8_t>(64, 7), true));
  const auto received = frames_of(read_until(source, frames(2)));
  const std::int64_t after_ns = now_ns();
  ASSERT_EQ(received.size(), 2U);
  EXPECT_FALSE(received[0].fd);
  EXPECT_EQ(received[0].id, 0x123U);
  EXPECT_EQ(received[0].length, 3);
  EXPECT_EQ(received[0].data[2], 3);
  EXPECT_TRUE(received[0].sent_here);
  EXPECT_TRUE(received[1].fd);
  EXPECT_TRUE(received[1].bit_rate_switch);
  EXPECT_TRUE(received[1].extended);
  EXPECT_EQ(received[1].length, 64);
  for (const CanFrame& frame : received) {
    EXPECT_GE(frame.kernel_ns, before_ns);
    EXPECT_LE(frame.kernel_ns, after_ns);
    EXPECT_EQ(frame.hardware_ns, 0);
  }
}

TEST(SocketCan, LetsOnlyTheFramesOfItsFiltersThrough) {
  const VirtualCan link("vcan0");
  SocketCanSource source(on("vcan0"));
  ASSERT_TRUE(source.open(sensor_only));
  Sender sender("vcan0");
  sender.send(0x124, {1});
  sender.send(0x123 | CAN_EFF_FLAG, {2});
  sender.send(0x123 | CAN_RTR_FLAG, {});
  sender.send(0x123, {4});
  const auto received = frames_of(read_until(source, frames(1)));
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].data[0], 4);
}

TEST(SocketCan, TellsWhatErrorFramesSay) {
  const VirtualCan link("vcan0");
  SocketCanSource source(on("vcan0"));
  ASSERT_TRUE(source.open(sensor_only));
  Sender sender("vcan0");
  sender.send(CAN_ERR_FLAG | 0x004 | 0x200,
              {0, 0x20, 0, 0, 0, 0, 130, 10}); // transmit passive, with counters
  sender.send(CAN_ERR_FLAG | 0x008, {0, 0, 0x04, 0x0A, 0, 0, 0, 0});  // stuff error
  sender.send(CAN_ERR_FLAG | 0x040, std::vector<std::uint8_t>(8, 0)); // bus-off
  const auto events = read_until(source, [](const auto& all) { return all.size() >= 3; });
  ASSERT_EQ(events.size(), 3U);
  const auto& passive = std::get<BusFault>(events[0]);
  EXPECT_EQ(passive.state, BusState::error_passive);
  EXPECT_EQ(passive.transmit_errors, 130);
  EXPECT_EQ(std::get<BusFault>(events[1]).cause, "stuff error");
  EXPECT_EQ(std::get<BusFault>(events[2]).state, BusState::bus_off);
}

TEST(SocketCan, GoesOnAfterTheInterfaceWasDownAndUp) {
  const VirtualCan link("vcan0");
  SocketCanSource source(on("vcan0"));
  ASSERT_TRUE(source.open(sensor_only));
  ip("set vcan0 down");
  EXPECT_TRUE(says("is down")(read_until(source, says("is down"))));
  ip("set vcan0 up");
  EXPECT_TRUE(says("is up")(read_until(source, says("is up"))));
  Sender("vcan0").send(0x123, {9});
  EXPECT_EQ(frames_of(read_until(source, frames(1))).size(), 1U);
}

TEST(SocketCan, PutsFramesThatWaitedAcrossADownAndUpBetweenTwoInterruptions) {
  const VirtualCan link("vcan0");
  // The kernel may hand over what was sent only later. It hands a frame to sockets with the same
  // filter one after the other, to the newest first: what this one has, the other one has too.
  SocketCanSource witness(on("vcan0"));
  ASSERT_TRUE(witness.open(sensor_only));
  SocketCanSource source(on("vcan0"));
  ASSERT_TRUE(source.open(sensor_only));
  for (std::uint8_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(Sender("vcan0").send(0x123, {i}));
  }
  ASSERT_EQ(frames_of(read_until(witness, frames(3))).size(), 3U);
  ip("set vcan0 down");
  ip("set vcan0 up");
  for (std::uint8_t i = 3; i < 100; ++i) {
    ASSERT_TRUE(Sender("vcan0").send(0x123, {i}));
  }
  ASSERT_EQ(frames_of(read_until(witness, frames(97))).size(), 97U);
  const auto events = read_until(source, says("is up"));
  ASSERT_TRUE(says("is up")(events));
  const auto* before = std::get_if<LinkChange>(&events.front());
  ASSERT_NE(before, nullptr);
  EXPECT_TRUE(before->interrupted);
  EXPECT_THAT(before->what, HasSubstr("'vcan0' was down while frames waited"));
  for (std::size_t i = 0; i < 100; ++i) {
    const auto* frame = std::get_if<CanFrame>(&events.at(1 + i));
    ASSERT_NE(frame, nullptr) << i;
    EXPECT_EQ(frame->data[0], i);
  }
}

TEST(SocketCan, ReadsOutWhatCameBeforeTheInterfaceWent) {
  auto link = std::make_unique<VirtualCan>("vcan0");
  SocketCanSource source(on("vcan0"));
  ASSERT_TRUE(source.open(sensor_only));
  for (std::uint8_t i = 0; i < 100; ++i) {
    ASSERT_TRUE(Sender("vcan0").send(0x123, {i}));
  }
  link.reset();
  const auto events = read_until(source, says("has gone"));
  ASSERT_TRUE(says("has gone")(events));
  EXPECT_EQ(frames_of(events).size(), 100U);
  EXPECT_TRUE(std::holds_alternative<CanFrame>(events.front()));
}

TEST(SocketCan, OpensAnInterfaceAgainThatWasUnpluggedAndComesBack) {
  auto link = std::make_unique<VirtualCan>("vcan0");
  SocketCanSource source(on("vcan0"));
  ASSERT_TRUE(source.open(sensor_only));
  link.reset();
  const auto gone = read_until(source, says("has gone"));
  ASSERT_TRUE(says("has gone")(gone));
  EXPECT_TRUE(std::get<LinkChange>(gone.back()).interrupted);
  link = std::make_unique<VirtualCan>("vcan0");
  EXPECT_TRUE(says("is up")(read_until(source, says("is up"))));
  Sender("vcan0").send(0x123, {9});
  EXPECT_EQ(frames_of(read_until(source, frames(1))).size(), 1U);
}

TEST(SocketCan, FollowsAnInterfaceThatIsRenamed) {
  VirtualCan link("vcan0");
  SocketCanSource source(on("vcan0"));
  ASSERT_TRUE(source.open(sensor_only));
  ip("set vcan0 down");
  ip("set vcan0 name shaker0");
  ip("set shaker0 up");
  EXPECT_TRUE(says("'shaker0' is up")(read_until(source, says("'shaker0' is up"))));
  Sender("shaker0").send(0x123, {9});
  EXPECT_EQ(frames_of(read_until(source, frames(1))).size(), 1U);
  ip("del shaker0");
}

TEST(SocketCan, CountsEveryFrameThatOverloadLost) {
  const VirtualCan link("vcan0");
  SocketCanSettings settings;
  settings.interface_name = "vcan0";
  settings.receive_buffer_bytes = 64 << 10;
  SocketCanSource source(settings);
  ASSERT_TRUE(source.open(sensor_only));
  Sender sender("vcan0");
  constexpr std::size_t sent = 5000;
  for (std::size_t i = 0; i < sent; ++i) {
    ASSERT_TRUE(sender.send(0x123, {static_cast<std::uint8_t>(i)}));
  }
  std::vector<BusEvent> events;
  static_cast<void>(source.read(
      events, std::chrono::milliseconds(20))); // makes room for the frame that carries the count
  sender.send(0x123, {0});
  std::uint64_t received = 0;
  std::uint64_t lost = 0;
  const auto take = [&](const std::vector<BusEvent>& some) {
    received += frames_of(some).size();
    for (const BusEvent& event : some) {
      if (const auto* dropped = std::get_if<FramesLost>(&event)) {
        lost += dropped->frames;
      }
    }
  };
  take(events);
  for (bool more = true; more;) {
    events.clear();
    static_cast<void>(source.read(events, std::chrono::milliseconds(50)));
    more = !events.empty();
    take(events);
  }
  EXPECT_GT(lost, 0U);
  EXPECT_EQ(received + lost, sent + 1);
}

TEST(SocketCan, StopsFromAnotherThreadWhileItWaits) {
  const VirtualCan link("vcan0");
  SocketCanSource source(on("vcan0"));
  ASSERT_TRUE(source.open(sensor_only));
  std::jthread stopper([&] { source.stop(); });
  std::vector<BusEvent> events;
  for (auto state = ReadState::more; state != ReadState::stopped;) {
    state = source.read(events, std::chrono::seconds(10)).value();
  }
}

// DYNCAL_CAN_SECONDS=60 for the long form.
int load_seconds() {
  const char* wished = std::getenv("DYNCAL_CAN_SECONDS");
  return wished == nullptr ? 10 : std::atoi(wished);
}

TEST(SocketCan, LosesNoFrameAt8000FramesPerSecond) {
  const VirtualCan link("vcan0");
  SocketCanSource source(on("vcan0"));
  ASSERT_TRUE(source.open(sensor_only));
  const int seconds = load_seconds();
  constexpr int rate_hz = 8000;
  const auto sent = static_cast<std::uint32_t>(seconds * rate_hz);
  ASSERT_GT(sent, 0U);
  std::atomic<std::uint32_t> not_sent = 0;
  const auto begin = std::chrono::steady_clock::now();
  std::jthread sender_thread([&](const std::stop_token& stop) {
    Sender sender("vcan0");
    const auto start = std::chrono::steady_clock::now();
    for (std::uint32_t i = 0; i < sent && !stop.stop_requested(); ++i) {
      if (i % 8 == 0) {
        std::this_thread::sleep_until(
            start +
            std::chrono::microseconds(1'000'000LL * i / rate_hz)); // bursts of a millisecond
      }
      std::vector<std::uint8_t> data(8, 0);
      std::memcpy(data.data(), &i, sizeof i);
      if (!sender.send(0x123, data)) {
        ++not_sent;
      }
    }
  });
  std::uint32_t next = 0;
  std::uint64_t dropped = 0;
  std::uint64_t out_of_order = 0;
  std::vector<BusEvent> events;
  const auto deadline = begin + std::chrono::seconds(seconds + 30);
  while (next < sent && std::chrono::steady_clock::now() < deadline) {
    events.clear();
    ASSERT_TRUE(source.read(events, std::chrono::milliseconds(100)));
    for (const BusEvent& event : events) {
      if (const auto* lost = std::get_if<FramesLost>(&event)) {
        dropped += lost->frames;
      }
      const auto* frame = std::get_if<CanFrame>(&event);
      if (frame == nullptr) {
        continue;
      }
      std::uint32_t number = 0;
      std::memcpy(&number, frame->data.data(), sizeof number);
      out_of_order += number == next ? 0 : 1;
      next = number + 1;
    }
  }
  EXPECT_EQ(not_sent, 0U);
  EXPECT_EQ(dropped, 0U);
  EXPECT_EQ(out_of_order, 0U);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  // A machine that has no time for the sender says nothing about the reader.
  if (!HasFailure() && (next < sent || taken.count() > 1.1 * seconds)) {
    std::printf("skipped: this machine was too busy to send %d frames/s; of %u frames in %.0f s "
                "none was lost\n",
                rate_hz, next, taken.count());
  }
}

} // namespace
} // namespace dyncal::drivers::can
