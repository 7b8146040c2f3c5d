#include "drivers/interferometer/running_ellipse.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/drivers/interferometer/simulated_device.hpp"

namespace dyncal::tests {
namespace {

using drivers::interferometer::FoundEllipse;
using drivers::interferometer::RunningEllipse;

struct Adopted {
  double at_s = 0.0;
  FoundEllipse found;
};

// What is adopted in the course of a record, in blocks of 4096 pairs.
std::vector<Adopted> adopted(RunningEllipse& running, const DeviceSettings& device,
                             const std::optional<analysis::Ellipse>& used = {}) {
  const drivers::SampleBlock record = record_of(device);
  const std::vector<double> u1 = column_of(record, 0);
  const std::vector<double> u2 = column_of(record, 1);
  std::vector<Adopted> all;
  std::optional<analysis::QuadraturePhase> phase;
  if (used) {
    phase.emplace(*used);
  }
  std::vector<double> turns(4096);
  for (std::size_t at = 0; at + 4096 <= u1.size(); at += 4096) {
    const auto x = std::span(u1).subspan(at, 4096);
    const auto y = std::span(u2).subspan(at, 4096);
    analysis::EllipseMoments sums;
    sums.add(x, y);
    analysis::PhaseStatistics seen;
    if (phase) {
      phase->forget_extremes();
      EXPECT_TRUE(phase->push(x, y, std::span(turns)));
      seen = phase->statistics();
    }
    if (const auto found = running.add(x, y, sums, seen)) {
      all.push_back({static_cast<double>(at) / device.rate_hz, *found});
      phase ? phase->adopt(found->ellipse) : void(phase.emplace(found->ellipse));
    }
  }
  return all;
}

DeviceSettings slow_device(double seconds) {
  DeviceSettings device;
  device.rate_hz = 100e3;
  device.seconds = seconds;
  return device;
}

double off(const FoundEllipse& found, const analysis::Ellipse& truth) {
  const auto errors = analysis::ellipse_difference(truth, found.ellipse);
  return std::hypot(errors[0], errors[1]);
}

TEST(RunningEllipse, IsFoundAtOnceWhereFringesRun) {
  const DeviceSettings device = slow_device(1.0);
  RunningEllipse running(device.rate_hz);
  const auto all = adopted(running, device);
  ASSERT_FALSE(all.empty());
  EXPECT_LT(all.front().at_s, 0.1);
  EXPECT_LT(off(all.front().found, device.ellipse), 2e-3);
  EXPECT_EQ(all.front().found.method, analysis::EllipseMethod::linear);
}

// Equally good ones take the place of an old one twice a minute, no more often.
TEST(RunningEllipse, IsKeptForAWhile) {
  const DeviceSettings device = slow_device(70.0);
  RunningEllipse running(device.rate_hz);
  const auto all = adopted(running, device);
  EXPECT_GE(all.size(), 3U);
  EXPECT_LE(all.size(), 7U);
  for (const Adopted& one : all) {
    const double stated = std::hypot(one.found.errors_rad[0], one.found.errors_rad[1]);
    EXPECT_LT(off(one.found, device.ellipse), 4.0 * stated + 1e-5);
  }
}

TEST(RunningEllipse, FollowsDetectorsThatChange) {
  DeviceSettings device = slow_device(2.0);
  RunningEllipse running(device.rate_hz);
  const auto first = adopted(running, device);
  ASSERT_FALSE(first.empty());
  device.ellipse.p += 0.02;
  device.seconds = 45.0;
  const auto later = adopted(running, device, first.back().found.ellipse);
  ASSERT_FALSE(later.empty());
  EXPECT_LT(off(later.back().found, device.ellipse), 2e-3);
}

TEST(RunningEllipse, IsNotTakenFromAShortArc) {
  DeviceSettings device = slow_device(3.0);
  device.motion = {.frequency_hz = 1000.0, .displacement_m = 2e-8, .drift_m_s = 0.0};
  RunningEllipse running(device.rate_hz);
  EXPECT_TRUE(adopted(running, device).empty());
  EXPECT_FALSE(running.problem().empty());
}

// The first one of a whole turn takes the place of an adjusted one at once.
TEST(RunningEllipse, PrefersAWholeTurn) {
  DeviceSettings device = slow_device(8.0);
  device.motion = {.frequency_hz = 100.0, .displacement_m = 6e-8, .drift_m_s = 3e-7};
  RunningEllipse running(device.rate_hz);
  const auto all = adopted(running, device);
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(all.back().found.method, analysis::EllipseMethod::linear);
  EXPECT_LT(off(all.back().found, device.ellipse), 5e-3);
}

} // namespace
} // namespace dyncal::tests
