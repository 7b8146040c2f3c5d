#include "drivers/virtual_bench/can/can_bus.hpp"

#include <gtest/gtest.h>

#include "drivers/virtual_bench/can/can_sensor.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

using drivers::can::CanFrame;

const drivers::can::BitRates half_megabit{500e3, 0.0};

CanFrame frame_of(std::uint32_t id, std::uint8_t length = 8) {
  CanFrame frame;
  frame.id = id;
  frame.length = length;
  return frame;
}

TEST(CanBus, SendsAFrameAtOnceWhenItIsIdleAndForAsLongAsItsBitsLast) {
  CanBus bus(half_megabit);
  bus.offer(frame_of(0x100), 1.0);
  EXPECT_FALSE(bus.next_before(1.0));
  const auto sent = bus.next_before(1.1);
  ASSERT_TRUE(sent);
  EXPECT_DOUBLE_EQ(sent->start_s, 1.0);
  EXPECT_NEAR(sent->end_s - sent->start_s,
              drivers::can::frame_duration_s(frame_of(0x100), half_megabit), 1e-12);
}

TEST(CanBus, LetsTheLowestIdGoFirstButInterruptsNothing) {
  CanBus bus(half_megabit);
  bus.offer(frame_of(0x400), 0.0);
  bus.offer(frame_of(0x200), 10e-6); // both wait for the first
  bus.offer(frame_of(0x100), 20e-6);
  const auto first = bus.next_before(1.0);
  const auto second = bus.next_before(1.0);
  const auto third = bus.next_before(1.0);
  EXPECT_EQ(first->frame.id, 0x400U);
  EXPECT_EQ(second->frame.id, 0x100U);
  EXPECT_EQ(third->frame.id, 0x200U);
  EXPECT_NEAR(second->start_s - first->end_s, 6e-6, 1e-12); // intermission
  EXPECT_NEAR(third->start_s - second->end_s, 6e-6, 1e-12);
}

TEST(CanSensor, NumbersEverySampleAndSharesTheBusWithTheOthers) {
  CanSensorSettings settings;
  settings.preset = *drivers::virtual_bench::preset_by_name("mpu9250-ptb");
  settings.bus = can_bus_kinds().front();
  settings.background_load = 0.3;
  CanSensor sensor(settings);
  const drivers::virtual_bench::Excitation at_rest{drivers::virtual_bench::ExciterModel{}};
  double busy_until_s = 0.0;
  double foreign_s = 0.0;
  std::uint64_t samples = 0;
  std::uint64_t waited = 0;
  for (int slice = 1; slice <= 500; ++slice) {
    sensor.advance_to(0.02 * slice, at_rest, [&](const SentFrame& sent) {
      EXPECT_GE(sent.start_s, busy_until_s);
      EXPECT_GE(sent.start_s, sent.ready_s);
      busy_until_s = sent.end_s;
      if (sent.frame.id != CanSensor::id) {
        foreign_s += sent.end_s - sent.start_s;
        return;
      }
      EXPECT_EQ(sent.frame.data[6] | sent.frame.data[7] << 8, static_cast<int>(samples & 0xFFFF));
      EXPECT_NEAR(sent.ready_s,
                  static_cast<double>(samples) / sensor.rate_hz() + settings.latency_s, 1e-9);
      waited += sent.start_s > sent.ready_s ? 1 : 0;
      ++samples;
    });
  }
  EXPECT_NEAR(static_cast<double>(samples), 10.0 * sensor.rate_hz(), 2.0);
  EXPECT_NEAR(foreign_s / 10.0, 0.3, 0.03);
  EXPECT_GT(waited, samples / 5);
  EXPECT_LT(waited, samples / 2);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
