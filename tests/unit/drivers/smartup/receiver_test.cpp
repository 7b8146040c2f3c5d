#include "drivers/smartup/receiver.hpp"

#include <chrono>
#include <condition_variable>
#include <functional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/patience.hpp"
#include "tests/unit/drivers/smartup/datagram_writer.hpp"
#include "tests/unit/drivers/smartup/recording.hpp"
#include "tests/unit/drivers/smartup/udp_sender.hpp"

namespace dyncal::drivers::smartup {
namespace {

using testing::HasSubstr;
using tests::DatagramWriter;
using tests::UdpSender;

constexpr std::uint32_t sensor_id = 0xbccb0100;

bool eventually(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) {
      return false;
    }
    std::this_thread::yield();
  }
  return true;
}

DatagramWriter datagram_from(std::uint32_t first, std::uint32_t sensor = sensor_id) {
  DatagramWriter datagram("DATA");
  for (std::uint32_t n = first; n < first + 12; ++n) {
    datagram.data({.sensor = sensor,
                   .sample_number = n,
                   .stamp_ns = 1'600'000'000'000'000'000 + n * 1'000'000LL});
  }
  return datagram;
}

Receiver::Endpoint endpoint(tests::Recording& sink, const std::string& listen = "127.0.0.1:0") {
  return {.listen = listen,
          .wanted = {sink.wanted({.sensor = sensor_id, .sync_sensor = {}, .naming = {}})},
          .observer = &sink};
}

TEST(ListenAddress, IsAnAddressAndAPort) {
  const auto listen = parse_listen_address("192.168.0.5:7654");
  ASSERT_TRUE(listen);
  EXPECT_EQ(listen->address, 0xc0a80005U);
  EXPECT_EQ(listen->port, 7654);
  EXPECT_EQ(parse_listen_address(":7000")->address, 0U);
  for (const auto* bad : {"", "7654", "localhost:7654", "1.2.3:7654", "1.2.3.4:", "1.2.3.4:65536",
                          "1.2.3.4:-1", "1.2.3.4:7654x", "[::1]:7654"}) {
    const auto refused = parse_listen_address(bad);
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_setting);
    EXPECT_THAT(refused.error().message, HasSubstr("IPV4-ADDRESS:PORT"));
  }
}

TEST(Receiver, ReceivesOverUdpFromSeveralUnitsAtSeveralPorts) {
  tests::Recording first;
  tests::Recording second;
  auto receiver = Receiver::create({endpoint(first), endpoint(second)});
  ASSERT_TRUE(receiver) << receiver.error().message;
  (*receiver)->start();
  UdpSender to_first((*receiver)->port(0));
  UdpSender to_second((*receiver)->port(1));
  for (std::uint32_t n = 1; n <= 1200; n += 12) {
    EXPECT_TRUE(to_first.send(datagram_from(n).bytes()));
    to_second.send(datagram_from(n).bytes());
  }
  EXPECT_TRUE(eventually(
      [&] { return first.samples(sensor_id) == 1200 && second.samples(sensor_id) == 1200; }));
  (*receiver)->stop();
  EXPECT_EQ(first.reports.at(sensor_id).counts.received, 1200U);
  EXPECT_EQ(first.reception.dropped_by_kernel, 0U);
  EXPECT_EQ(second.reception.datagrams, 100U);
}

TEST(Receiver, HandsOverASlowSensorsSampleInTime) {
  tests::Recording sink;
  auto receiver = Receiver::create({endpoint(sink)});
  ASSERT_TRUE(receiver);
  (*receiver)->start();
  UdpSender sender((*receiver)->port(0));
  EXPECT_TRUE(sender.send(DatagramWriter("DATA").data({.sample_number = 1}).bytes()));
  EXPECT_TRUE(eventually([&] { return sink.samples(sensor_id) == 1; }));
}

TEST(Receiver, CountsWhatTheKernelHadToDrop) {
  tests::Recording sink;
  auto small = endpoint(sink);
  small.receive_buffer_bytes = 4096;
  auto receiver = Receiver::create({small});
  ASSERT_TRUE(receiver);
  UdpSender sender((*receiver)->port(0));
  for (std::uint32_t n = 1; n <= 1200; n += 12) {
    EXPECT_TRUE(sender.send(datagram_from(n).bytes())); // nobody reads yet
  }
  (*receiver)->start();
  // The count comes with the next datagram that is received.
  std::uint32_t n = 1201;
  EXPECT_TRUE(eventually([&] {
    EXPECT_TRUE(sender.send(datagram_from(n).bytes()));
    n += 12;
    const std::lock_guard lock(sink.mutex);
    return sink.reception.dropped_by_kernel > 0;
  }));
  (*receiver)->stop();
  EXPECT_GT(sink.reports.at(sensor_id).counts.lost_on_way, 0U);
  EXPECT_EQ(sink.reports.at(sensor_id).counts.lost_in_unit, 0U);
}

TEST(Receiver, CountsDatagramsThatNoUnitSends) {
  tests::Recording sink;
  auto receiver = Receiver::create({endpoint(sink)});
  ASSERT_TRUE(receiver);
  (*receiver)->start();
  UdpSender sender((*receiver)->port(0));
  EXPECT_TRUE(sender.send(std::vector<std::uint8_t>(5000, 'D')));
  sender.send({'D', 'A'});
  EXPECT_TRUE(sender.send({}));
  EXPECT_TRUE(eventually([&] {
    const std::lock_guard lock(sink.mutex);
    return sink.reception.too_long == 1 && sink.reception.rejected[0] == 2;
  }));
}

TEST(Receiver, SaysWhenAnAddressIsInUse) {
  tests::Recording sink;
  auto receiver = Receiver::create({endpoint(sink)});
  ASSERT_TRUE(receiver);
  const auto refused =
      Receiver::create({endpoint(sink, "127.0.0.1:" + std::to_string((*receiver)->port(0)))});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::refused);
  EXPECT_THAT(refused.error().message, HasSubstr("another program uses this port"));
}

TEST(Receiver, SaysWhenAnAddressIsNotOfThisHost) {
  tests::Recording sink;
  const auto refused = Receiver::create({endpoint(sink, "192.0.2.1:7654")});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("no such address"));
}

TEST(Receiver, AsksForALargeBuffer) {
  tests::Recording sink;
  auto receiver = Receiver::create({endpoint(sink)});
  ASSERT_TRUE(receiver);
  EXPECT_GE((*receiver)->receive_buffer_bytes(0), 200 * 1024);
}

TEST(Receiver, StopsAtOnceAndOnlyOnce) {
  tests::Recording sink;
  auto receiver = Receiver::create({endpoint(sink)});
  ASSERT_TRUE(receiver);
  (*receiver)->stop();
  (*receiver)->start();
  (*receiver)->stop();
  (*receiver)->stop();
}

} // namespace
} // namespace dyncal::drivers::smartup
