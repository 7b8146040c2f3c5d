#include "drivers/interferometer/quadrature_demodulator.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/drivers/interferometer/simulated_device.hpp"

namespace dyncal::tests {
namespace {

using drivers::interferometer::InterferometerSettings;
using drivers::interferometer::QuadratureDemodulator;
using drivers::interferometer::StatedEllipse;

// The phase of every sample, pushed in parts of drawn lengths.
std::vector<double> turns_of(QuadratureDemodulator& demodulator, const drivers::SampleBlock& record,
                             std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::vector<double> u1 = column_of(record, 0);
  const std::vector<double> u2 = column_of(record, 1);
  std::vector<double> turns;
  for (std::size_t at = 0; at < u1.size();) {
    const std::size_t n = std::min<std::size_t>(1 + random() % 9000, u1.size() - at);
    demodulator.push(std::span(u1).subspan(at, n), std::span(u2).subspan(at, n), turns);
    at += n;
  }
  return turns;
}

double true_turns(const DeviceSettings& device, std::size_t i) {
  return 2.0 * device.motion.at(static_cast<double>(i) / device.rate_hz) / device.wavelength_m;
}

// Adopting a better ellipse leaves no step in the phase.
TEST(QuadratureDemodulator, IsContinuousWhenItAdoptsAnEllipse) {
  DeviceSettings device;
  device.noise_rel = 0.01;
  device.seconds = 2.0;
  device.rate_hz = 200e3;
  device.motion = {.frequency_hz = 80.0, .displacement_m = 8e-8, .drift_m_s = 4e-7};
  QuadratureDemodulator demodulator({.u1 = "u1", .u2 = "u2"}, {}, device.rate_hz);
  const std::vector<double> turns = turns_of(demodulator, record_of(device), 31);
  ASSERT_TRUE(demodulator.has_ellipse());
  EXPECT_GE(demodulator.described().turns_covered, 1.0);
  std::size_t known = 0;
  double last = 0.0;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const double error = turns[i] - true_turns(device, i);
    if (!std::isfinite(turns[i])) {
      known = 0;
      continue;
    }
    if (known++ > 0) {
      ASSERT_LT(std::abs(error - last), 0.02) << i; // noise alone
    }
    last = error;
  }
  EXPECT_GT(known, turns.size() / 2);
}

TEST(QuadratureDemodulator, TakesAStatedEllipseFromTheFirstSample) {
  DeviceSettings device;
  device.seconds = 0.1;
  InterferometerSettings settings{.u1 = "u1", .u2 = "u2"};
  settings.ellipse = StatedEllipse{
      .ellipse = device.ellipse, .u_rad = {1e-3, 2e-3}, .turns_covered = 3.0, .from = "a test"};
  QuadratureDemodulator demodulator(settings, {}, device.rate_hz);
  const std::vector<double> turns = turns_of(demodulator, record_of(device), 32);
  for (std::size_t i = 1; i < turns.size(); ++i) {
    ASSERT_NEAR(turns[i] - turns[0], true_turns(device, i) - true_turns(device, 0), 0.01);
  }
  const drivers::QuadratureSignals& described = demodulator.described();
  EXPECT_EQ(described.ellipse_from, "a test");
  EXPECT_EQ(described.radius_u1, device.ellipse.radius);
  EXPECT_EQ(described.u_ellipse_rad, (std::vector{1e-3, 2e-3}));
}

// A residual fourth harmonic is found, once the phase has gone round.
TEST(QuadratureDemodulator, LearnsTheResidualPeriodicError) {
  DeviceSettings device;
  device.seconds = 0.5;
  drivers::SampleBlock record = record_of(device);
  const double r = device.ellipse.radius;
  for (double& value : std::span(record.values).first(2 * record.samples)) {
    value -= 0.08 * std::pow(value / r, 3) * r; // saturates
  }
  QuadratureDemodulator demodulator({.u1 = "u1", .u2 = "u2"}, {}, device.rate_hz);
  turns_of(demodulator, record, 33);
  const std::vector<double>& errors = demodulator.described().periodic_error_rad;
  ASSERT_EQ(errors.size(), 4U);
  EXPECT_GT(errors[3], 0.01);
  EXPECT_LT(errors[3], 0.04);
  // Radius over phase, as measured: the fourth order of it is that error.
  const std::vector<double>& deviations = demodulator.described().radius_deviation_rel;
  ASSERT_EQ(deviations.size(), analysis::radius_parts);
  std::complex<double> fourth;
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    fourth += std::polar(2.0 * deviations[i] / static_cast<double>(deviations.size()),
                         -8.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) /
                             static_cast<double>(deviations.size()));
  }
  EXPECT_NEAR(std::abs(fourth), errors[3], 0.05 * errors[3]);
}

// Of a stated ellipse, too, whose periodic error is not replaced.
TEST(QuadratureDemodulator, ShowsTheRadiusOfAStatedEllipse) {
  DeviceSettings device;
  device.seconds = 0.5;
  InterferometerSettings settings{.u1 = "u1", .u2 = "u2"};
  const std::array<double, 4> stated{0.0, 0.0, 0.0, 0.006};
  analysis::Ellipse moved = device.ellipse;
  moved.p += 0.01 * device.ellipse.radius;
  settings.ellipse = StatedEllipse{.ellipse = moved, .periodic_error_rad = stated};
  QuadratureDemodulator demodulator(settings, {}, device.rate_hz);
  turns_of(demodulator, record_of(device), 34);
  const drivers::QuadratureSignals& described = demodulator.described();
  EXPECT_EQ(described.periodic_error_rad, std::vector<double>(stated.begin(), stated.end()));
  ASSERT_EQ(described.radius_deviation_rel.size(), analysis::radius_parts);
  EXPECT_NEAR(described.radius_deviation_rel.front(), -0.01, 0.002); // the centre is too far right
  EXPECT_NEAR(described.radius_deviation_rel[analysis::radius_parts / 2], 0.01, 0.002);
}

TEST(QuadratureDemodulator, CountsByCause) {
  DeviceSettings device;
  device.seconds = 0.2;
  InterferometerSettings settings{.u1 = "u1", .u2 = "u2"};
  settings.ellipse = StatedEllipse{.ellipse = device.ellipse};
  drivers::SampleBlock record = record_of(device);
  const std::size_t n = record.samples;
  record.values[1000] = std::numeric_limits<double>::quiet_NaN();
  record.values[n + 20'000] = 1.0;
  for (std::size_t i = 40'000; i < 40'100; ++i) {
    record.values[i] = device.ellipse.p;
    record.values[n + i] = device.ellipse.q;
  }
  QuadratureDemodulator demodulator(
      settings, {analysis::SignalRange{-1.0, 1.0}, analysis::SignalRange{-1.0, 1.0}},
      device.rate_hz);
  const std::vector<double> turns = turns_of(demodulator, record, 34);
  EXPECT_EQ(demodulator.counts().not_measured, 1U);
  EXPECT_EQ(demodulator.counts().clipped, 1U);
  EXPECT_EQ(demodulator.counts().without_beam, 100U);
  EXPECT_EQ(demodulator.counts().doubtful, 0U);
  std::size_t lacking = 0;
  for (const double value : turns) {
    lacking += std::isnan(value) ? 1 : 0;
  }
  EXPECT_EQ(lacking, 102U);
}

} // namespace
} // namespace dyncal::tests
