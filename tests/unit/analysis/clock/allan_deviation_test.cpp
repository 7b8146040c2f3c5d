#include "analysis/clock/allan_deviation.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

// The 1000-point test suite of NIST SP 1065, section 12.4: a multiplicative congruential generator,
// frequency data.
std::vector<double> nist_phases() {
  std::vector<double> phases{0.0};
  std::int64_t n = 1234567890;
  for (int i = 0; i < 1000; ++i) {
    phases.push_back(phases.back() + static_cast<double>(n) / 2147483647.0);
    n = 16807 * n % 2147483647;
  }
  return phases;
}

TEST(AllanDeviation, MeetsTheTestSuiteOfNist) {
  const std::vector<double> phases = nist_phases();
  EXPECT_NEAR(overlapping_allan_deviation(phases, 1.0, 1), 2.922319e-01, 5e-8);
  EXPECT_NEAR(overlapping_allan_deviation(phases, 1.0, 10), 9.159953e-02, 5e-9);
  EXPECT_NEAR(overlapping_allan_deviation(phases, 1.0, 100), 3.241343e-02, 5e-9);
}

TEST(AllanDeviation, StreamOfStampsGivesTheSameAsPhases) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 50.0);
  StreamingAllan stream(1u << 12);
  std::vector<double> phases;
  for (int i = 0; i < 3000; ++i) {
    const std::int64_t error_ns = std::llround(noise(random));
    stream.add(1'700'000'000'000'000'000 + 485'000ll * i + error_ns);
    phases.push_back(static_cast<double>(error_ns) * 1e-9);
  }
  const auto points = stream.points(485e-6);
  ASSERT_EQ(points.size(), 10u); // m = 1 ... 512: more than m terms
  double m = 1.0;
  for (const AllanPoint& point : points) {
    EXPECT_NEAR(point.tau_s, m * 485e-6, 1e-15);
    EXPECT_NEAR(point.deviation /
                    overlapping_allan_deviation(phases, 485e-6, static_cast<std::size_t>(m)),
                1.0, 1e-9)
        << m;
    m *= 2.0;
  }
}

TEST(AllanDeviation, DoesNotReachAcrossAnInterruption) {
  StreamingAllan stream(1024);
  for (int stretch = 0; stretch < 3; ++stretch) {
    for (int i = 0; i < 100; ++i) {
      stream.add(1'000'000ll * stretch * stretch + 1000ll * i);
    }
    stream.interrupt();
  }
  for (const AllanPoint& point : stream.points(1e-6)) {
    EXPECT_EQ(point.deviation, 0.0);
  }
}

TEST(AllanDeviation, KeepsNoMoreStampsThanItMay) {
  StreamingAllan stream(64);
  for (int i = 0; i < 10000; ++i) {
    stream.add(1000ll * i);
  }
  EXPECT_EQ(stream.points(1e-6).size(), 5u); // m = 1 ... 16: 2 m + 1 of 64
}

TEST(AllanDeviation, TooFewPhasesGiveNone) {
  EXPECT_EQ(overlapping_allan_deviation(std::vector<double>{0, 1}, 1.0, 1), 0.0);
}

} // namespace
} // namespace dyncal::analysis
