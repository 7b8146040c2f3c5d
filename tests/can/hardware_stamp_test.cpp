// From a USB adapter with a clock of its own to time-stamped samples, against the instants at which
// the frames began: drift, latency, interruptions, wrap of the adapter's clock. In simulated time;
// of the long run numbers, values, losses and the adapter's stamps are the same to the last bit
// every time.
#include <cinttypes>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/timex.h>

#include "drivers/can/time/clock_line.hpp"
#include "drivers/can/time/frame_duration.hpp"
#include "tests/can/played_sensor.hpp"

namespace dyncal::drivers::can {
namespace {

using ::testing::HasSubstr;
using tests::drifting;
using tests::GsUsbSettings;
using tests::ip;
using tests::now_ns;

constexpr double limit_in_u = 4.0;

class HardwareStamps : public tests::PlayedSensor {};

TEST_F(HardwareStamps, AreChosenByThemselvesAndMarkTheStartOfFrameWithinTheirUncertainty) {
  plug_in(drifting(50.0), "bitrate 1000000");
  open();
  send(10'000);
  finish();
  EXPECT_EQ(stream->time_source(), TimeSource::hardware_stamp);
  EXPECT_THAT(samples.description.driver, HasSubstr("time by hardware-stamp"));
  EXPECT_EQ(samples.description.tick_s, 1e-6);
  EXPECT_EQ(samples.all.size(), 10'000U);
  expect_true_stamps();
}

TEST_F(HardwareStamps, CoverTheLatencyOfUsbWhereNobodyHasMeasuredIt) {
  plug_in(drifting(50.0), "bitrate 1000000");
  sensor.latency_s = 0.0;
  sensor.u_latency_s.reset();
  open();
  EXPECT_EQ(stream->link().device_bus, "usb");
  send(3'000);
  finish();
  expect_true_stamps(0, 2.0);
  EXPECT_GT(max_error_ns, 100e3); // the latency, which nothing in the data shows
}

TEST_F(HardwareStamps, BecomeCertainInUtcWhenTheHostsClockIsSynchronised) {
  plug_in(drifting(50.0), "bitrate 1000000");
  sensor.time_base = TimeBase::utc;
  sensor.counter = "counter";
  sensor.time_source = TimeSource::hardware_stamp;
  sensor.nominal_rate_hz = rate_hz;
  open();
  EXPECT_GT(samples.description.stamp_uncertainty_s, 9.0);
  send(3'000);
  timex synchronised{};
  synchronised.modes = ADJ_STATUS | ADJ_MAXERROR;
  synchronised.maxerror = 100; // us; the kernel lets it grow by 500 us a second
  ASSERT_GE(::adjtimex(&synchronised), 0);
  send(3'000);
  finish();
  EXPECT_GT(samples.all.front().u_ns, 4e9);
  EXPECT_LT(samples.all.back().u_ns, 2e6);
  EXPECT_LT(samples.description.stamp_uncertainty_s, 2e-3);
  timex as_before{};
  as_before.modes = ADJ_STATUS;
  as_before.status = STA_UNSYNC;
  ASSERT_GE(::adjtimex(&as_before), 0);
}

TEST_F(HardwareStamps, LeadToTheRateOfTheAdaptersClockAndTheLeastLatency) {
  for (const double ppm : {-80.0, 50.0}) {
    plug_in(drifting(ppm), "bitrate 1000000");
    open();
    ClockLine line;
    double latency_sum_s = 0.0;
    std::size_t compared = 0;
    const double duration_ns = frame_duration_s(next_frame(), played.bus) * 1e9;
    const std::int64_t first_ns = now_ns();
    for (std::int64_t i = 0; i < 10'000; ++i) {
      adapter->put(next_frame(), first_ns + i * 1'000'000);
    }
    std::int64_t number = 0;
    for (std::vector<BusEvent> events; number < 10'000; events.clear()) {
      ASSERT_TRUE(source->read(events, std::chrono::milliseconds(100)));
      for (const CanFrame& frame : tests::frames_of(events)) {
        line.add(frame.hardware_ns, frame.kernel_ns);
        const double end_ns = static_cast<double>(number * 1'000'000) + duration_ns;
        if (number++ < 5'000) {
          continue;
        }
        latency_sum_s +=
            (static_cast<double>(line.to_host(frame.hardware_ns) - first_ns) - end_ns) * 1e-9;
        ++compared;
      }
    }
    const double latency_s = latency_sum_s / static_cast<double>(compared);
    std::printf("%+.0f ppm: rate %+.3f ppm, latency %.2f us, u %.2f us\n", ppm, line.rate() * 1e6,
                latency_s * 1e6, line.u_s() * 1e6);
    EXPECT_NEAR(line.rate(), -ppm * 1e-6 / (1.0 + ppm * 1e-6), limit_in_u * line.u_s() / 10.0);
    EXPECT_NEAR(latency_s, played.min_latency_s,
                limit_in_u * std::hypot(line.u_s(), 1e-6 / std::sqrt(12.0)));
    EXPECT_LT(line.u_s(), 5e-6);
    source.reset();
    adapter.reset();
  }
}

TEST_F(HardwareStamps, OfAnAdapterThatStampsTheStartOfFrameAreTakenAsSuch) {
  GsUsbSettings settings = drifting(-30.0);
  settings.stamp_point = StampPoint::start_of_frame;
  settings.bus = {500e3, 0.0};
  plug_in(settings, "bitrate 500000");
  open();
  send(5'000);
  finish();
  expect_true_stamps();
}

TEST_F(HardwareStamps, AreWrongByTheFramesDurationWhereItIsNotCorrected) {
  plug_in(drifting(50.0), "bitrate 1000000");
  sensor.correct_frame_duration = false;
  open();
  send(5'000);
  finish();
  double sum_us = 0.0;
  for (const tests::Sample& sample : samples.all) {
    sum_us += static_cast<double>(sample.stamp_ns - starts_ns.at(sample.serial)) * 1e-3;
  }
  const double duration_us = frame_duration_s(next_frame(), played.bus) * 1e6;
  std::printf("late by %.1f us, a frame has %.1f us\n",
              sum_us / static_cast<double>(samples.all.size()), duration_us);
  EXPECT_NEAR(sum_us / static_cast<double>(samples.all.size()), duration_us, 0.1 * duration_us);
}

TEST_F(HardwareStamps, BeginANewLineWhenTheLinkWasDown) {
  plug_in(drifting(100.0), "bitrate 1000000");
  sensor.counter = "counter";
  sensor.time_source = TimeSource::hardware_stamp;
  sensor.nominal_rate_hz = rate_hz;
  open();
  send(8'000);
  ip("set " + adapter->name(0) + " down");
  send(150);
  ip("set " + adapter->name(0) + " up");
  send(8'000);
  finish();
  EXPECT_GE(samples.missing(), 150U);
  EXPECT_LE(samples.missing(), 250U); // and those on their way
  expect_true_stamps(5);
}

TEST_F(HardwareStamps, BeginANewLineWhenTheAdapterWasPulledOut) {
  plug_in(drifting(-100.0), "bitrate 1000000");
  sensor.counter = "counter";
  sensor.time_source = TimeSource::hardware_stamp;
  sensor.nominal_rate_hz = rate_hz;
  open();
  send(5'000);
  adapter->unplug();
  send(1'000);
  adapter->plug_in();
  adapter->set_up(0, timing);
  send(5'000);
  finish();
  EXPECT_GE(samples.missing(), 1'000U);
  expect_true_stamps(5);
}

TEST_F(HardwareStamps, GoOnWhereTheClockOfTheAdapterWraps) {
  GsUsbSettings settings = drifting(50.0);
  settings.clock_start_us = 0xFFFFFFFFU - 6'000'000U;
  plug_in(settings, "bitrate 1000000");
  open();
  send(12'000);
  finish();
  EXPECT_LT(adapter->clock_us(now_ns()), settings.clock_start_us); // it did
  EXPECT_EQ(stream->counts().clock_restarts, 0U);
  expect_true_stamps();
}

TEST_F(HardwareStamps, AreDemandedInOneLineWhereTheAdapterHasNone) {
  GsUsbSettings settings;
  settings.stamps = false;
  plug_in(settings, "bitrate 1000000");
  sensor.time_source = TimeSource::hardware_stamp;
  open();
  adapter->put(next_frame(), now_ns());
  std::vector<BusEvent> events;
  while (tests::frames_of(events).empty()) {
    ASSERT_TRUE(source->read(events, std::chrono::milliseconds(100)));
  }
  const auto taken = stream->take(events.back(), samples);
  ASSERT_FALSE(taken);
  EXPECT_THAT(taken.error().message, HasSubstr("the adapter stamps no frames"));
}

class LongRun : public HardwareStamps {};

TEST_F(LongRun, OfAnHourAndAHalfCountsEverySampleAndStampsItTrueAcrossEveryWrapAndInterruption) {
  rate_hz = 10.0;
  GsUsbSettings settings = drifting(50.0);
  settings.bus = {500e3, 0.0};
  plug_in(settings, "bitrate 500000");
  sensor.counter = "counter"; // 8 bits: 25.6 s
  sensor.time_source = TimeSource::hardware_stamp;
  sensor.nominal_rate_hz = rate_hz;
  constexpr std::size_t minute = 600; // samples
  open();
  send(10 * minute);
  ip("set " + adapter->name(0) + " down");
  send(5 * minute);
  ip("set " + adapter->name(0) + " up");
  const std::uint32_t before_us = adapter->clock_us(now_ns());
  send(60 * minute);
  EXPECT_LT(adapter->clock_us(now_ns()), before_us); // wrapped
  adapter->unplug();
  send(12 * minute);
  adapter->plug_in();
  adapter->set_up(0, timing);
  send(5 * minute);
  finish();
  EXPECT_GE(samples.all.size(), 75 * minute - 10);
  EXPECT_GE(samples.missing(), 17 * minute);
  EXPECT_EQ(stream->counts().clock_restarts, 0U);
  expect_true_stamps(5, 10.0); // at 10 Hz a line of a few seconds rests on few points
  for (const tests::Sample& sample : samples.all) {
    digest.add(sample.number);
    digest.add(sample.serial);
    digest.add(sample.flags);
  }
  for (const std::uint64_t count :
       {stream->counts().frames, stream->counts().lost, stream->counts().interruptions}) {
    digest.add(count);
  }
  std::printf("digest %016" PRIx64 " of the adapter's stamps, numbers, values, losses\n",
              digest.value());
}

} // namespace
} // namespace dyncal::drivers::can
