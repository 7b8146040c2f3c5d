#include "analysis/clock/sync_clock_monitor.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::int64_t epoch_ns = 1'700'000'000'000'000'000;

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> sync;
};

// 200 Hz, 60 dB. In the middle either the clock of the DAU jumps or the sensor takes its samples
// later from then on.
Record record(double clock_jump_s, double sensor_jump_s, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1e-3);
  Record result;
  for (int i = 0; i < 10'000; ++i) {
    const double t = i * 1e-3 + (i >= 5000 ? sensor_jump_s : 0.0);
    result.stamps_ns.push_back(epoch_ns +
                               std::llround((t + (i >= 5000 ? clock_jump_s : 0.0)) * 1e9));
    result.sync.push_back(1.5 + std::sin(2.0 * std::numbers::pi * 200.0 * t + 0.7) + noise(random));
  }
  return result;
}

EventOrigin origin(const Record& record, double size_s) {
  const auto comparison =
      compare_clock_with_sync(*Frequency::parse("200"), record.stamps_ns, record.sync, 100);
  return origin_of_event(comparison.value(), record.stamps_ns[4999], size_s);
}

TEST(SyncClockMonitor, ComparesTheClockToTensOfNanoseconds) {
  const Record steady = record(0.0, 0.0);
  const auto comparison =
      compare_clock_with_sync(*Frequency::parse("200"), steady.stamps_ns, steady.sync, 200);
  ASSERT_TRUE(comparison.has_value());
  ASSERT_EQ(comparison->size(), 9u);
  for (const ClockComparison& block : *comparison) {
    EXPECT_NEAR(block.u_error_s, 36e-9, 3e-9); // sqrt(2 / 1000) 1e-3 / w
    EXPECT_LT(std::abs(block.error_s), 5.0 * block.u_error_s);
  }
}

TEST(SyncClockMonitor, AJumpOfTheClockMovesSyncAgainstTheStamps) {
  EXPECT_EQ(origin(record(2e-6, 0.0), 2e-6), EventOrigin::dau_clock);
  EXPECT_EQ(origin(record(-2e-6, 0.0), -2e-6), EventOrigin::dau_clock);
}

TEST(SyncClockMonitor, ALateSampleOfTheSensorDoesNot) {
  EXPECT_EQ(origin(record(0.0, 2e-6), 2e-6), EventOrigin::sensor);
}

TEST(SyncClockMonitor, WhatIsSmallerThanTheNoiseStaysUndecided) {
  EXPECT_EQ(origin(record(1e-8, 0.0), 1e-8), EventOrigin::undecided);
}

TEST(SyncClockMonitor, NeedsThreeBlocks) {
  const Record steady = record(0.0, 0.0);
  EXPECT_EQ(compare_clock_with_sync(*Frequency::parse("200"), steady.stamps_ns, steady.sync, 1000)
                .error()
                .code,
            ErrorCode::too_few_samples);
  EXPECT_FALSE(compare_clock_with_sync(*Frequency::parse("200"), {}, {}, 1).has_value());
}

} // namespace
} // namespace dyncal::analysis
