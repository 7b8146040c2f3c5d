// Every sample that is lost in an adapter, on its bus or while nobody reads is in the counts, and
// no sample is stamped wrong for it.
#include <ctime>

#include <gtest/gtest.h>

#include "tests/can/played_sensor.hpp"

namespace dyncal::drivers::can {
namespace {

using tests::drifting;
using tests::ip;
using tests::now_ns;
using tests::second_ns;

void pass(std::int64_t time_ns) {
  const timespec pause{time_ns / second_ns, time_ns % second_ns};
  ::nanosleep(&pause, nullptr);
}

class AdapterLosses : public tests::PlayedSensor {
protected:
  void open_with_counter(double ppm) {
    plug_in(drifting(ppm), "bitrate 1000000");
    sensor.counter = "counter";
    sensor.time_source = TimeSource::hardware_stamp;
    sensor.nominal_rate_hz = rate_hz;
    open();
  }
};

TEST_F(AdapterLosses, OfItsOwnBufferAreCounted) {
  open_with_counter(50.0);
  send(2'000);
  adapter->overrun(7);
  send(2'000);
  finish();
  EXPECT_GE(samples.missing(), 7U);
  EXPECT_LE(samples.missing(), 9U); // and the sensor's pause between the two
  EXPECT_EQ(stream->counts().faults.at("controller overrun"), 1U);
  expect_true_stamps();
}

TEST_F(AdapterLosses, OfItsOwnBufferAreMarkedByAGapWhereNothingCountsSamples) {
  plug_in(drifting(50.0), "bitrate 1000000");
  open();
  send(2'000);
  adapter->overrun(7);
  send(2'000);
  take_until(now_ns() + second_ns / 100);
  stream->finish(samples);
  EXPECT_EQ(samples.all.size(), 3'993U);
  EXPECT_EQ(samples.missing(), 1U); // how many nobody knows
}

TEST_F(AdapterLosses, OfABusOffAreCounted) {
  open_with_counter(50.0);
  send(2'000);
  adapter->bus_off(0);
  send(100);
  EXPECT_EQ(stream->link().bus, BusState::bus_off);
  EXPECT_EQ(stream->link().transmit_errors, 255);
  adapter->recover(0);
  send(2'000);
  finish();
  EXPECT_EQ(stream->link().bus, BusState::error_active);
  EXPECT_GE(samples.missing(), 99U);
  EXPECT_LE(samples.missing(), 105U);
  EXPECT_EQ(stream->counts().faults.at("bus-off"), 1U);
  EXPECT_EQ(stream->counts().faults.at("controller restarted"), 1U);
  expect_true_stamps();
}

// What came before and what came after stand in one queue when the reader gets to it, and the
// adapter's clock has jumped between them.
TEST_F(AdapterLosses, OfALinkThatWentDownAndUpWhileNobodyReadAreCountedAndLeaveNoWrongStamp) {
  open_with_counter(400.0);
  send(5'000);
  const auto unheard = [&](int frames) {
    for (int i = 0; i < frames; ++i, next_start_ns += second_ns / 1000) {
      if (next_start_ns >= now_ns()) {
        adapter->put(next_frame(), next_start_ns);
      }
      starts_ns.push_back(next_start_ns);
    }
  };
  unheard(40);
  pass(second_ns / 25);
  ip("set " + adapter->name(0) + " down");
  ip("set " + adapter->name(0) + " up");
  while (next_start_ns < now_ns()) {
    unheard(1);
  }
  unheard(40);
  pass(second_ns / 25);
  send(5'000);
  finish();
  expect_true_stamps(100);
  EXPECT_LT(max_error_ns, 100e3);
}

} // namespace
} // namespace dyncal::drivers::can
