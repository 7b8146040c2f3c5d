// The whole chain with an adapter that stamps: sensor -> bus -> USB adapter with a clock of its own
// -> gs_usb -> dyncal-can -> DDS -> dyncal-analysis -> result, against the truth of the virtual
// bench, with other devices on the bus, in simulated time. The wire is the virtual interface on
// which the virtual bench puts each frame at its end. The sensor is received as it is meant to
// ("can": its counter, over the adapter's clock) and, from the same frames, by the adapter's stamps
// with and without correction of the frame's duration.
#include <thread>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/can/bus/socketcan_source.hpp"
#include "drivers/can/time/frame_duration.hpp"
#include "tests/can/can_calibration.hpp"
#include "tests/can/gs_usb_adapter.hpp"

namespace dyncal::tests {
namespace {

using drivers::can::StampPoint;

constexpr double limit_in_u = 4.0;

// Puts what is written to the wire on the adapter's bus. The kernel's stamp of a virtual interface
// is the end of the frame.
class Tap {
public:
  Tap(const drivers::can::BitRates& rates, GsUsbAdapter& adapter) {
    source_.emplace(on("vcan0"));
    const auto opened = source_->open({{0, 0, false}});
    EXPECT_TRUE(opened) << opened.error().message;
    thread_ = std::jthread([this, rates, &adapter](const std::stop_token& stop) {
      for (std::vector<BusEvent> events; !stop.stop_requested(); events.clear()) {
        static_cast<void>(source_->read(events, std::chrono::milliseconds(100)));
        for (const CanFrame& frame : frames_of(events)) {
          adapter.put(frame, frame.kernel_ns -
                                 std::llround(drivers::can::frame_duration_s(frame, rates) * 1e9));
        }
      }
    });
  }

private:
  std::optional<drivers::can::SocketCanSource> source_;
  std::jthread thread_; // last: ends before what it uses
};

struct Played {
  Bus bus;
  StampPoint stamp_point;
};

class HardwareChain : public testing::TestWithParam<Played> {};

TEST_P(HardwareChain, MeetsTheTruthWithin4uAndIsWrongByTheFramesDurationWithoutItsCorrection) {
  const auto& [bus, stamp_point] = GetParam();
  CanCalibration calibration("hardware_chain", bus);
  GsUsbSettings played;
  played.bus = bus.rates;
  played.clock_ppm = 50.0;
  played.stamp_point = stamp_point;
  GsUsbAdapter adapter(played);
  adapter.set_up(0,
                 fmt::format("bitrate {:.0f}", bus.rates.nominal_per_s) +
                     (bus.fd ? fmt::format(" dbitrate {:.0f} fd on", bus.rates.data_per_s) : ""));
  const Tap tap(bus.rates, adapter);
  // The bit rates are those that the interface says.
  const std::string point =
      stamp_point == StampPoint::start_of_frame ? "start-of-frame" : "end-of-frame";
  const std::string settings =
      "hardware_stamp_point = \"" + point + "\"\nlatency_s = 100e-6\nu_latency_s = 2e-6\n";
  calibration.add_source("can", adapter.name(0), settings);
  calibration.add_source("stamp", adapter.name(0), settings + "time_source = \"hardware-stamp\"\n");
  calibration.add_source(
      "raw", adapter.name(0),
      settings + "time_source = \"hardware-stamp\"\nframe_duration_correction = false\n");
  const auto points = calibration.run(
      {"can/acceleration_x", "can/acceleration_y", "can/acceleration_z", "stamp/acceleration_x",
       "stamp/acceleration_y", "stamp/acceleration_z", "raw/acceleration_z"});
  if (!points || HasFailure()) {
    return;
  }
  calibration.expect_truth(*points, "can", limit_in_u);
  calibration.expect_truth(*points, "stamp", limit_in_u);
  if (stamp_point == StampPoint::end_of_frame) {
    calibration.expect_late_by_a_frame(*points, "stamp", "raw");
  }
}

std::vector<Played> all_played() {
  std::vector<Played> all;
  for (const Bus& bus : calibrated_buses()) {
    all.push_back({bus, StampPoint::end_of_frame});
  }
  all[1].stamp_point = StampPoint::start_of_frame;
  return all;
}

INSTANTIATE_TEST_SUITE_P(Buses, HardwareChain, testing::ValuesIn(all_played()),
                         [](const auto& played) { return bus_name(played.param.bus); });

} // namespace
} // namespace dyncal::tests
