// A USB adapter with hardware stamps and CAN FD, by the kernel's own driver (gs_usb): what it
// tells, and what is told of its faults.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can/error.h>

#include "drivers/can/bus/socketcan_source.hpp"
#include "drivers/can/time/frame_duration.hpp"
#include "tests/can/gs_usb_adapter.hpp"
#include "tests/can/kernel_can.hpp"

namespace dyncal::drivers::can {
namespace {

using ::testing::HasSubstr;
using tests::frames;
using tests::frames_of;
using tests::GsUsbAdapter;
using tests::GsUsbSettings;
using tests::now_ns;
using tests::on;
using tests::read_until;
using tests::says;
using tests::Sender;
using tests::told;

const std::vector<FrameFilter> sensor_only = {{0x123, 0x7FF, false}};
constexpr std::int64_t millisecond_ns = 1'000'000;

CanFrame sensor_frame(std::uint8_t length = 8, bool fd = false) {
  CanFrame frame;
  frame.id = 0x123;
  frame.length = length;
  frame.fd = frame.bit_rate_switch = fd;
  for (std::size_t i = 0; i < length; ++i) {
    frame.data[i] = static_cast<std::uint8_t>(17 * i);
  }
  return frame;
}

std::string failure(const SocketCanSettings& settings) {
  const auto link = SocketCanSource(settings).open(sensor_only);
  return link ? "opened" : link.error().message;
}

struct Scatter {
  double slope_us = 0.0;
  double rms_us = 0.0;
};

// Stamps against the number of their frame.
template <class Stamp>
Scatter scatter_about_line(const std::vector<CanFrame>& received, Stamp stamp_ns) {
  const double n = static_cast<double>(received.size());
  const double middle = (n - 1.0) / 2.0;
  double sum = 0.0;
  double weighted = 0.0;
  double squares = 0.0;
  const auto value_us = [&](std::size_t i) {
    return static_cast<double>(stamp_ns(received[i]) - stamp_ns(received[0])) * 1e-3;
  };
  for (std::size_t i = 0; i < received.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    sum += value_us(i);
    weighted += x * value_us(i);
    squares += x * x;
  }
  Scatter scatter{weighted / squares, 0.0};
  for (std::size_t i = 0; i < received.size(); ++i) {
    const double residual_us =
        value_us(i) - sum / n - scatter.slope_us * (static_cast<double>(i) - middle);
    scatter.rms_us += residual_us * residual_us;
  }
  scatter.rms_us = std::sqrt(scatter.rms_us / n);
  return scatter;
}

// What one error frame says.
struct Told {
  std::uint32_t classes;
  std::array<std::uint8_t, 8> data;
  const char* cause;
  BusState state;
};

TEST(GsUsb, GivesEveryFrameTheAdaptersStampWithTheKernels) {
  GsUsbSettings settings;
  settings.bus = {500e3, 0.0};
  GsUsbAdapter adapter(settings);
  adapter.set_up(0, "bitrate 500000");
  SocketCanSource source(on(adapter.name(0)));
  const auto link = source.open(sensor_only);
  ASSERT_TRUE(link) << link.error().message;
  EXPECT_EQ(link->bit_rate_per_s, 500'000U);
  EXPECT_FALSE(link->fd);
  const std::int64_t first_ns = now_ns() + millisecond_ns;
  constexpr std::size_t sent = 50;
  for (std::size_t i = 0; i < sent; ++i) {
    adapter.put(sensor_frame(), first_ns + static_cast<std::int64_t>(i) * millisecond_ns);
  }
  const auto received = frames_of(read_until(source, frames(sent)));
  ASSERT_EQ(received.size(), sent);
  const std::int64_t duration_ns =
      std::llround(frame_duration_s(sensor_frame(), settings.bus) * 1e9);
  for (std::size_t i = 0; i < sent; ++i) {
    const std::int64_t end_ns =
        first_ns + static_cast<std::int64_t>(i) * millisecond_ns + duration_ns;
    EXPECT_GT(received[i].hardware_ns, 0);
    EXPECT_GE(received[i].kernel_ns - end_ns, 100'000);
    EXPECT_LE(received[i].kernel_ns - end_ns, 3 * millisecond_ns);
    EXPECT_NEAR(static_cast<double>(received[i].hardware_ns - received[0].hardware_ns),
                static_cast<double>(i) * 1e6, 1000.0);
  }
}

TEST(GsUsb, StampsWithTheRateAndTheResolutionOfItsClock) {
  GsUsbSettings settings;
  settings.clock_ppm = 50.0;
  GsUsbAdapter adapter(settings);
  adapter.set_up(0, "bitrate 1000000");
  SocketCanSource source(on(adapter.name(0)));
  ASSERT_TRUE(source.open(sensor_only));
  constexpr std::size_t sent = 5000;
  const std::int64_t first_ns = now_ns() + millisecond_ns;
  for (std::size_t i = 0; i < sent; ++i) {
    adapter.put(sensor_frame(), first_ns + static_cast<std::int64_t>(i) * millisecond_ns);
  }
  const auto received = frames_of(read_until(source, frames(sent)));
  ASSERT_EQ(received.size(), sent);
  const Scatter hardware =
      scatter_about_line(received, [](const CanFrame& frame) { return frame.hardware_ns; });
  const Scatter kernel =
      scatter_about_line(received, [](const CanFrame& frame) { return frame.kernel_ns; });
  std::printf("slope %.4f us, residual rms %.3f us; kernel's stamps: slope %.4f us, rms %.1f us\n",
              hardware.slope_us, hardware.rms_us, kernel.slope_us, kernel.rms_us);
  EXPECT_NEAR(hardware.slope_us, 1000.05, 1e-4);
  EXPECT_NEAR(hardware.rms_us, 1.0 / std::sqrt(12.0), 0.01);
  EXPECT_GT(kernel.rms_us, 300.0);
}

TEST(GsUsb, ReceivesFdFramesOf64BytesWithBitRateSwitchAndKnowsBothRates) {
  GsUsbAdapter adapter({});
  adapter.set_up(0, "bitrate 1000000 dbitrate 5000000 fd on");
  SocketCanSettings settings = on(adapter.name(0));
  settings.bit_rate_per_s = 1'000'000;
  settings.data_bit_rate_per_s = 5'000'000;
  SocketCanSource source(settings);
  const auto link = source.open(sensor_only);
  ASSERT_TRUE(link) << link.error().message;
  EXPECT_EQ(link->bit_rate_per_s, 1'000'000U);
  EXPECT_EQ(link->data_bit_rate_per_s, 5'000'000U);
  EXPECT_TRUE(link->fd);
  EXPECT_EQ(adapter.rates(0).data_per_s, 5e6);
  adapter.put(sensor_frame(64, true), now_ns());
  adapter.put(sensor_frame(), now_ns());
  const auto received = frames_of(read_until(source, frames(2)));
  ASSERT_EQ(received.size(), 2U);
  EXPECT_TRUE(received[0].fd);
  EXPECT_TRUE(received[0].bit_rate_switch);
  ASSERT_EQ(received[0].length, 64);
  EXPECT_EQ(received[0].data, sensor_frame(64, true).data);
  EXPECT_GT(received[0].hardware_ns, 0);
  EXPECT_FALSE(received[1].fd);
}

TEST(GsUsb, RefusesBitRatesOtherThanTheBenchFilesInOneLine) {
  GsUsbAdapter adapter({});
  adapter.set_up(0, "bitrate 1000000 dbitrate 5000000 fd on");
  SocketCanSettings nominal = on(adapter.name(0));
  nominal.bit_rate_per_s = 500'000;
  EXPECT_THAT(failure(nominal),
              HasSubstr("interface '" + adapter.name(0) +
                        "' runs at a bit rate of 1000000 bit/s, the bench file says 500000"));
  SocketCanSettings data = on(adapter.name(0));
  data.bit_rate_per_s = 1'000'000;
  data.data_bit_rate_per_s = 2'000'000;
  EXPECT_THAT(failure(data), HasSubstr("runs at a data bit rate of 5000000 bit/s, the bench file "
                                       "says 2000000; change one of them"));
}

TEST(GsUsb, SaysThatTheBusDoesNotRunAtTheBitRateThatTheInterfaceHas) {
  GsUsbSettings settings;
  settings.bus = {250e3, 0.0};
  GsUsbAdapter adapter(settings);
  adapter.set_up(0, "bitrate 500000");
  SocketCanSource source(on(adapter.name(0)));
  ASSERT_TRUE(source.open(sensor_only));
  for (int i = 0; i < 20; ++i) {
    adapter.put(sensor_frame(), now_ns() + i * millisecond_ns);
  }
  const auto events = read_until(source, says("error passive"));
  ASSERT_TRUE(says("error passive")(events)) << told(events);
  EXPECT_TRUE(says("stuff error")(events)) << told(events);
  EXPECT_TRUE(frames_of(events).empty());
  const auto& last = std::get<BusFault>(events.back());
  EXPECT_EQ(last.state, BusState::error_passive);
  EXPECT_EQ(last.receive_errors, 128);
}

TEST(GsUsb, TellsEveryStateAndErrorOfTheController) {
  GsUsbAdapter adapter({});
  adapter.set_up(0, "bitrate 1000000 dbitrate 5000000 fd on");
  SocketCanSource source(on(adapter.name(0)));
  ASSERT_TRUE(source.open(sensor_only));
  constexpr std::uint32_t counted = 0x200; // CAN_ERR_CNT
  const std::vector<Told> all = {
      {CAN_ERR_CRTL | counted,
       {0, CAN_ERR_CRTL_RX_WARNING, 0, 0, 0, 0, 20, 100},
       "error warning",
       BusState::error_warning},
      {CAN_ERR_CRTL | counted,
       {0, CAN_ERR_CRTL_TX_PASSIVE, 0, 0, 0, 0, 130, 10},
       "error passive",
       BusState::error_passive},
      {CAN_ERR_CRTL | counted,
       {0, CAN_ERR_CRTL_ACTIVE, 0, 0, 0, 0, 90, 9},
       "error active again",
       BusState::error_active},
      {CAN_ERR_ACK | counted, {0, 0, 0, 0, 0, 0, 8, 0}, "no acknowledgment", BusState::unknown},
      {CAN_ERR_PROT | CAN_ERR_BUSERROR | counted,
       {0, 0, CAN_ERR_PROT_STUFF, 0x0A, 0, 0, 0, 1},
       "stuff error",
       BusState::unknown},
      {CAN_ERR_PROT | counted,
       {0, 0, CAN_ERR_PROT_FORM, 0, 0, 0, 0, 2},
       "form error",
       BusState::unknown},
      {CAN_ERR_PROT | counted,
       {0, 0, CAN_ERR_PROT_BIT0, 0, 0, 0, 3, 0},
       "bit error",
       BusState::unknown},
      {CAN_ERR_PROT | counted,
       {0, 0, 0, CAN_ERR_PROT_LOC_CRC_SEQ, 0, 0, 0, 3},
       "checksum error",
       BusState::unknown},
  };
  for (const Told& one : all) {
    adapter.say_error(0, one.classes, one.data);
    const auto events = read_until(source, says(one.cause));
    ASSERT_EQ(events.size(), 1U) << one.cause << ": " << told(events);
    const auto& fault = std::get<BusFault>(events.front());
    EXPECT_EQ(fault.cause, one.cause);
    EXPECT_EQ(fault.state, one.state) << one.cause;
    EXPECT_EQ(fault.transmit_errors, one.data[6]) << one.cause;
    EXPECT_EQ(fault.receive_errors, one.data[7]) << one.cause;
    EXPECT_FALSE(fault.frames_lost);
  }
}

TEST(GsUsb, TellsOfFramesThatTheAdapterHadNoRoomFor) {
  GsUsbAdapter adapter({});
  adapter.set_up(0, "bitrate 1000000");
  SocketCanSource source(on(adapter.name(0)));
  ASSERT_TRUE(source.open(sensor_only));
  adapter.overrun(3);
  for (int i = 0; i < 5; ++i) {
    adapter.put(sensor_frame(), now_ns() + i * millisecond_ns);
  }
  const auto events = read_until(source, frames(2));
  EXPECT_EQ(frames_of(events).size(), 2U);
  const auto with_overrun = read_until(
      source, [&](const auto& more) { return says("overrun")(events) || says("overrun")(more); });
  EXPECT_TRUE(says("controller overrun")(events) || says("controller overrun")(with_overrun));
}

TEST(GsUsb, LeavesTheBusAndComesBackWithItsCarrierUp) {
  GsUsbAdapter adapter({});
  adapter.set_up(0, "bitrate 1000000");
  SocketCanSource source(on(adapter.name(0)));
  ASSERT_TRUE(source.open(sensor_only));
  adapter.bus_off(0);
  const auto off = read_until(source, says("bus-off"));
  ASSERT_EQ(off.size(), 1U) << told(off);
  EXPECT_EQ(std::get<BusFault>(off.front()).state, BusState::bus_off);
  const auto monitor = LinkMonitor::open(adapter.name(0));
  ASSERT_TRUE(monitor);
  EXPECT_EQ(monitor->state().bus, BusState::bus_off);
  EXPECT_TRUE(monitor->state().carrier);
  adapter.put(sensor_frame(), now_ns());
  std::vector<BusEvent> heard;
  ASSERT_TRUE(source.read(heard, std::chrono::milliseconds(20)));
  EXPECT_TRUE(heard.empty());
  adapter.recover(0);
  const auto back = read_until(source, says("controller restarted"));
  ASSERT_EQ(back.size(), 1U) << told(back);
  EXPECT_EQ(std::get<BusFault>(back.front()).state, BusState::error_active);
  adapter.put(sensor_frame(), now_ns());
  EXPECT_EQ(frames_of(read_until(source, frames(1))).size(), 1U);
}

TEST(GsUsb, IsSetDownAndUpAfterBusOffWhereItsFirmwareDoesNotComeBack) {
  GsUsbAdapter adapter({});
  adapter.set_up(0, "bitrate 1000000");
  SocketCanSettings settings = on(adapter.name(0));
  settings.restart_after_bus_off = std::chrono::milliseconds(100);
  SocketCanSource source(settings);
  ASSERT_TRUE(source.open(sensor_only));
  adapter.bus_off(0);
  const auto events = read_until(source, says("interface set down and up after bus-off"));
  ASSERT_TRUE(says("interface set down and up after bus-off")(events)) << told(events);
  adapter.put(sensor_frame(), now_ns());
  EXPECT_EQ(frames_of(read_until(source, frames(1))).size(), 1U);
}

TEST(GsUsb, IsOpenedAgainWhenItIsPluggedInAgain) {
  GsUsbAdapter adapter({});
  adapter.set_up(0, "bitrate 1000000");
  SocketCanSource source(on(adapter.name(0)));
  ASSERT_TRUE(source.open(sensor_only));
  adapter.unplug();
  const auto gone = read_until(source, says("has gone"));
  ASSERT_TRUE(says("has gone")(gone)) << told(gone);
  adapter.plug_in();
  adapter.set_up(0, "bitrate 1000000");
  const auto back = read_until(source, says("is up"));
  ASSERT_TRUE(says("is up")(back)) << told(back);
  adapter.put(sensor_frame(), now_ns());
  const auto received = frames_of(read_until(source, frames(1)));
  ASSERT_EQ(received.size(), 1U);
  EXPECT_GT(received[0].hardware_ns, 0);
}

TEST(GsUsb, StampsTheEchoOfAFrameThatThisHostSends) {
  GsUsbAdapter adapter({});
  adapter.set_up(0, "bitrate 1000000");
  adapter.set_up(1, "bitrate 1000000");
  SocketCanSource source(on(adapter.name(0)));
  SocketCanSource other(on(adapter.name(1)));
  ASSERT_TRUE(source.open(sensor_only));
  ASSERT_TRUE(other.open(sensor_only));
  ASSERT_TRUE(Sender(adapter.name(0)).send(0x123, {1, 2, 3}));
  const auto echo = frames_of(read_until(source, frames(1)));
  const auto heard = frames_of(read_until(other, frames(1)));
  ASSERT_EQ(echo.size(), 1U);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_TRUE(echo[0].sent_here);
  EXPECT_FALSE(heard[0].sent_here);
  EXPECT_EQ(echo[0].data, heard[0].data);
  EXPECT_EQ(echo[0].hardware_ns, heard[0].hardware_ns); // one instant, one clock
}

TEST(GsUsb, GivesTheKernelsStampsAloneWhereTheAdapterHasNone) {
  GsUsbSettings settings;
  settings.stamps = false;
  GsUsbAdapter adapter(settings);
  adapter.set_up(0, "bitrate 1000000");
  SocketCanSource source(on(adapter.name(0)));
  ASSERT_TRUE(source.open(sensor_only));
  adapter.put(sensor_frame(), now_ns());
  const auto received = frames_of(read_until(source, frames(1)));
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].hardware_ns, 0);
  EXPECT_GT(received[0].kernel_ns, 0);
}

} // namespace
} // namespace dyncal::drivers::can
