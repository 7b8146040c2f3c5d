// The whole chain on a real kernel: sensor -> bus -> dyncal-can -> DDS -> dyncal-analysis ->
// result, against the truth of the virtual bench, with other devices on the bus. Each bus has the
// sensor as it is meant to be received ("can", timed by its counter) and, from the same frames, by
// the kernel's stamps with and without correction of the frame's duration ("stamp", "raw").
#include <fstream>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/can/can_calibration.hpp"
#include "tests/can/kernel_can.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace dyncal::tests {
namespace {

constexpr double limit_in_u = 4.0;

class CanChain : public testing::TestWithParam<Bus> {};

TEST_P(CanChain, MeetsTheTruthWithin4uAndIsWrongByTheFramesDurationWithoutItsCorrection) {
  CanCalibration calibration("can_chain", GetParam());
  const drivers::can::BitRates& rates = GetParam().rates;
  std::string settings = fmt::format(
      "bit_rate_per_s = {:.0f}\nlatency_s = 10e-6\nu_latency_s = 20e-6\n", rates.nominal_per_s);
  if (GetParam().fd) {
    settings += fmt::format("data_bit_rate_per_s = {:.0f}\n", rates.data_per_s);
  }
  calibration.add_source("can", "vcan0", settings);
  calibration.add_source("stamp", "vcan0", settings + "time_source = \"kernel-stamp\"\n");
  calibration.add_source("raw", "vcan0",
                         settings +
                             "time_source = \"kernel-stamp\"\nframe_duration_correction = false\n");
  const auto points =
      calibration.run({"can/acceleration_x", "can/acceleration_y", "can/acceleration_z",
                       "stamp/acceleration_z", "raw/acceleration_z"});
  if (!points || HasFailure()) {
    return;
  }
  calibration.expect_truth(*points, "can", limit_in_u);
  calibration.expect_late_by_a_frame(*points, "stamp", "raw");
}

// The demonstration as people run it: a unit beside the sensor samples sync, and the command itself
// holds the result against the truth.
TEST(CanDemo, AgreesWithTheTruthWithSyncSampledBesideTheSensor) {
  const VirtualCan link("vcan0");
  const std::filesystem::path folder = fresh_folder("can_demo");
  ProgramRun demo("dyncal",
                  {"demo", "--preset", "can-sync", "--can", "vcan0", "--can-bus", "500k", "--dds",
                   "cyclonedds", "--domain", std::to_string(own_dds_domain()), "--output", folder},
                  folder);
  const auto status = demo.wait(patience);
  std::ifstream log(folder / "dyncal-virtual-bench.log");
  if (starved({std::istreambuf_iterator<char>(log), {}})) {
    return;
  }
  EXPECT_EQ(status, 0) << demo.errors();
  EXPECT_THAT(demo.output(),
              testing::HasSubstr("Against the truth of the virtual bench: 30 values"));
}

INSTANTIATE_TEST_SUITE_P(Buses, CanChain, testing::ValuesIn(calibrated_buses()),
                         [](const auto& played) { return bus_name(played.param); });

} // namespace
} // namespace dyncal::tests
