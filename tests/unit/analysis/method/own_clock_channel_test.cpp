#include "analysis/method/own_clock_channel.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/method/sample_stamping.hpp"
#include "tests/unit/analysis/sine/sine_signal.hpp"

namespace dyncal::analysis {
namespace {

// Reference and sync in the ACS's clock, sync in a DAU's, the sensor in a third series of stamps on
// the DAU's time scale.
struct Bench {
  std::string frequency_hz = "80";
  double delay_s = 1.5e-3;
  std::vector<std::int64_t> acs_stamps = uneven_stamps(20'000, 100'000, 5'000'000'000);
  std::vector<std::int64_t> dau_stamps = uneven_stamps(2'000);
  std::vector<std::int64_t> dut_stamps = uneven_stamps(1'500, 1'300'000, epoch_ns + 41'234'567);
  std::vector<double> reference;
  std::vector<double> sync_acs;
  std::vector<double> sync_dau;
  std::vector<double> dut;

  Bench() {
    // Both clocks show the same oscillation; what each calls zero differs by their epochs.
    const Signal at_acs{frequency_hz, 10.0, 0.7, 0.0, 5'000'000'000};
    const Signal at_dau{frequency_hz, 10.0, 0.7, 0.0, epoch_ns};
    Signal of_sensor = at_dau;
    of_sensor.amplitude *= 0.9;
    of_sensor.phase_rad -= 2.0 * std::numbers::pi * 80.0 * delay_s;
    reference = noisy(values_of(at_acs, acs_stamps), 0.01, 1);
    sync_acs = noisy(values_of(at_acs, acs_stamps), 0.001, 2);
    sync_dau = noisy(values_of(at_dau, dau_stamps), 0.001, 3);
    dut = noisy(values_of(of_sensor, dut_stamps), 0.02, 4);
  }

  [[nodiscard]] SampleStampingInput input() const {
    SampleStampingInput input{.frequency = *Frequency::parse(frequency_hz)};
    input.acs_stamps_ns = acs_stamps;
    input.reference = {"reference", reference, 0.0};
    input.sync_acs = {"sync_acs", sync_acs, 0.0};
    input.dau_stamps_ns = dau_stamps;
    input.sync_dau = {"sync_dau", sync_dau, 0.0};
    input.dut_stamps_ns = dut_stamps;
    input.dut = {{"sensor", dut, 0.0}};
    return input;
  }
};

TEST(OwnClockChannel, FindsTheTruthThoughTheSensorHasStampsOfItsOwn) {
  const Bench bench;
  const auto result = evaluate_sample_stamping(bench.input());
  ASSERT_TRUE(result) << result.error().message;
  const TransferPoint& point = result->points.at(0);
  EXPECT_NEAR(point.magnitude, 0.9, 4.0 * point.u_magnitude);
  EXPECT_NEAR(point.phase_rad, -2.0 * std::numbers::pi * 80.0 * bench.delay_s,
              4.0 * point.u_phase_rad);
  EXPECT_LT(point.u_phase_rad, 1e-3);
}

TEST(OwnClockChannel, CountsTheOffsetBetweenTheClocksInFull) {
  const Bench bench;
  SampleStampingInput input = bench.input();
  const double alone = evaluate_sample_stamping(input)->points.at(0).u_phase_rad;
  input.systematic.clock_offset_s = 20e-6;
  const double with_offset = evaluate_sample_stamping(input)->points.at(0).u_phase_rad;
  EXPECT_NEAR(with_offset, std::hypot(alone, 2.0 * std::numbers::pi * 80.0 * 20e-6), 1e-6);
}

TEST(OwnClockChannel, IsWrongByAnUnknownOffset) {
  Bench bench;
  for (std::int64_t& stamp : bench.dut_stamps) {
    stamp += 115'000; // as long as a frame of eight bytes lasts at 1 Mbit/s
  }
  const TransferPoint point = evaluate_sample_stamping(bench.input())->points.at(0);
  const double error_rad = point.phase_rad + 2.0 * std::numbers::pi * 80.0 * bench.delay_s;
  EXPECT_NEAR(error_rad, -2.0 * std::numbers::pi * 80.0 * 115e-6, 1e-3);
}

} // namespace
} // namespace dyncal::analysis
