#include "analysis/instrument/trigger_delay.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double first_s = -0.3e-6;
constexpr double interval_s = 1e-9;

std::vector<double> trace(const std::function<double(double)>& volts, std::size_t points = 1000,
                          double from_s = first_s) {
  std::vector<double> result(points);
  for (std::size_t i = 0; i < points; ++i) {
    result[i] = volts(from_s + static_cast<double>(i) * interval_s);
  }
  return result;
}

// From 0 V to 3 V within `rise_s`, half of it at `at_s`.
double edge(double time_s, double at_s, double rise_s) {
  return 3.0 * std::clamp((time_s - at_s) / rise_s + 0.5, 0.0, 1.0);
}

TEST(TriggerDelay, AnEdgeIsWhereItPassesHalfItsHeight) {
  for (const double at_s : {1.25e-8, 2.364e-7}) {
    const auto found =
        rising_edge_s(first_s, interval_s, trace([&](double t) { return edge(t, at_s, 8e-9); }));
    ASSERT_TRUE(found.has_value()) << found.error().message;
    EXPECT_NEAR(*found, at_s, 1e-15);
  }
}

TEST(TriggerDelay, AnEdgeSteeperThanTheSamplingIsFoundWithinOneSample) {
  const auto found =
      rising_edge_s(first_s, interval_s, trace([](double t) { return edge(t, 1.0004e-7, 1e-12); }));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(*found, 1.0004e-7, interval_s);
}

TEST(TriggerDelay, ATraceWithoutOneRisingEdgeIsRefused) {
  EXPECT_EQ(rising_edge_s(first_s, interval_s, trace([](double) { return 1.0; })).error().code,
            ErrorCode::no_excitation);
  EXPECT_EQ(rising_edge_s(first_s, interval_s, trace([](double t) { return -edge(t, 1e-7, 8e-9); }))
                .error()
                .code,
            ErrorCode::no_excitation);
  EXPECT_EQ(rising_edge_s(first_s, interval_s, trace([](double t) {
                            return edge(std::fmod(t + 1e-6, 3e-7), 1.5e-7, 8e-9);
                          }))
                .error()
                .code,
            ErrorCode::no_excitation); // several
  EXPECT_EQ(rising_edge_s(first_s, interval_s, std::vector<double>(5)).error().code,
            ErrorCode::too_few_samples);
}

TEST(TriggerDelay, ByTheRectangleIsFromEdgeToEdge) {
  const std::vector<double> sync = trace([](double t) { return edge(t, 3e-9, 8e-9); });
  const std::vector<double> output = trace([](double t) { return edge(t, 239e-9, 12e-9); });
  const auto delay = delay_by_rectangle({first_s, interval_s, sync, output});
  ASSERT_TRUE(delay.has_value()) << delay.error().message;
  EXPECT_NEAR(delay->output_delay_s, 236e-9, 1e-15);
}

TEST(TriggerDelay, ByTheSineDoesNotHoldWhatNoiseDidToTheTrigger) {
  constexpr double frequency_hz = 50'000.0;
  constexpr double beta = -0.02; // triggered 64 ns before the zero crossing
  constexpr double begin_s = -10e-6;
  const std::vector<double> sync = trace(
      [](double t) { return 0.1 + std::sin(2.0 * std::numbers::pi * frequency_hz * t + beta); },
      20000, begin_s);
  const std::vector<double> output =
      trace([](double t) { return edge(t, 236e-9, 12e-9); }, 20000, begin_s);
  const auto delay =
      delay_by_sine({begin_s, interval_s, sync, output}, Frequency::from_hz(frequency_hz));
  ASSERT_TRUE(delay.has_value()) << delay.error().message;
  EXPECT_NEAR(delay->output_delay_s, 236e-9, 1e-13);
  EXPECT_NEAR(delay->from_zero_crossing_s, 236e-9 + beta / (2.0 * std::numbers::pi * frequency_hz),
              1e-13);
}

TEST(TriggerDelay, TheMeanOverShotsHasScatterResolutionAndHistogram) {
  const std::vector<ShotDelay> shots{
      {235e-9, 200e-9}, {236e-9, 190e-9}, {237e-9, 210e-9}, {236e-9, 200e-9}};
  const auto mean = mean_trigger_delay(shots, interval_s);
  ASSERT_TRUE(mean.has_value());
  EXPECT_NEAR(mean->delay_s, 236e-9, 1e-18);
  EXPECT_NEAR(mean->scatter_s, std::sqrt(2.0 / 3.0) * 1e-9, 1e-18);
  EXPECT_NEAR(mean->of_delay.u, std::hypot(mean->scatter_s / 2.0, 1e-9 / std::sqrt(12.0)), 1e-18);
  EXPECT_NEAR(mean->of_delay.degrees_of_freedom, 3.0 * std::pow(1.5, 2), 1e-6);
  EXPECT_GT(mean->of_delay.k, 2.0);
  EXPECT_NEAR(mean->from_zero_crossing_s, 200e-9, 1e-18);
  EXPECT_EQ(
      std::accumulate(mean->histogram.counts.begin(), mean->histogram.counts.end(), std::size_t{0}),
      shots.size());
  EXPECT_NEAR(mean->histogram.first_s, 235e-9, 1e-18);
}

TEST(TriggerDelay, TwoShotsAreTooFew) {
  const std::vector<ShotDelay> shots(2);
  EXPECT_EQ(mean_trigger_delay(shots, interval_s).error().code, ErrorCode::too_few_samples);
}

} // namespace
} // namespace dyncal::analysis
