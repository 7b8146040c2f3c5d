#include "analysis/sine/stationary_line.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double rate_hz = 5000.0;

template <class Signal>
std::optional<LineAmplitude> line_of(double duration_s, unsigned seed, Signal signal) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  for (int i = 0; i < static_cast<int>(duration_s * rate_hz); ++i) {
    const double t = i / rate_hz;
    stamps_ns.push_back(std::llround(t * 1e9));
    values.push_back(signal(t) + noise(random));
  }
  return measure_stationary_line(50.0, 50.0, stamps_ns, values);
}

double hum(double t, double line_hz = 50.0) {
  return 0.05 * std::sin(2.0 * std::numbers::pi * line_hz * t + 0.3);
}

TEST(StationaryLine, HumLasts) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto line = line_of(0.5, seed, [](double t) { return hum(t); });
    ASSERT_TRUE(line) << seed;
    EXPECT_NEAR(line->amplitude, 0.05, 4.0 * line->u_component);
  }
  EXPECT_TRUE(line_of(0.5, 1, [](double t) { return hum(t, 50.05); })); // it wanders
}

// Decays of 20 to 200 ms, from 10 at the end of the step on, in quiet time that begins 0.1 s later.
TEST(StationaryLine, AnExciterThatRingsDownDoesNot) {
  for (const double tau_s : {0.02, 0.04, 0.06, 0.2}) {
    for (const double quiet_s : {0.16, 0.2, 0.25, 0.3, 0.6, 2.0}) {
      for (const double of_hz : {10.0, 25.0, 40.0, 49.0, 50.0, 63.0, 75.0, 100.0}) {
        const auto ringing = [&](double t) {
          return 10.0 * std::exp(-(t + 0.1) / tau_s) * std::sin(2.0 * std::numbers::pi * of_hz * t);
        };
        EXPECT_FALSE(line_of(quiet_s, 3, ringing)) << tau_s << ", " << quiet_s << ", " << of_hz;
      }
    }
  }
}

TEST(StationaryLine, NoiseIsNoLine) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    EXPECT_FALSE(line_of(0.5, seed, [](double) { return 0.0; }));
  }
}

TEST(StationaryLine, NeedsTwoPeriodsABlock) {
  EXPECT_FALSE(line_of(0.1, 1, [](double t) { return hum(t); }));
}

} // namespace
} // namespace dyncal::analysis
