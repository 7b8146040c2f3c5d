#include "analysis/step/settling.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
};

// 80 Hz whose amplitude lacks `missing` exp(-t / tau) and whose phase is off by the same; 4 s at 5
// kS/s.
Record record(double missing, double tau_s, double noise, double duration_s = 4.0) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  Record result;
  for (int i = 0; i < static_cast<int>(duration_s * 5000.0); ++i) {
    const double t = i * 2e-4;
    const double rest = missing * std::exp(-t / tau_s);
    result.stamps_ns.push_back(200'000ll * i);
    result.values.push_back((1.0 - rest) * std::sin(2.0 * std::numbers::pi * 80.0 * t + rest) +
                            noise * normal(random));
  }
  return result;
}

TEST(Settling, ASteadyRecordIsUsedWhole) {
  const Record steady = record(0.0, 1.0, 1e-3);
  const auto result = find_settling(*Frequency::parse("80"), steady.stamps_ns, steady.values);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->settling_s, 0.0);
  EXPECT_EQ(result->max_deviation, 0.0);
}

TEST(Settling, CutsOffAFirstOrderApproachWhereItNoLongerCounts) {
  const Record settling = record(0.5, 0.15, 1e-5);
  const auto result = find_settling(*Frequency::parse("80"), settling.stamps_ns, settling.values,
                                    {.tolerance_rel = 1e-4});
  ASSERT_TRUE(result.has_value()) << result.error().message;
  const double expected = 0.15 * std::log(0.5 * std::sqrt(2.0) / 1e-4);
  EXPECT_NEAR(result->settling_s, expected, 0.1);
  EXPECT_GT(result->max_deviation, 0.3);
}

TEST(Settling, NoiseHidesASmallRest) {
  const Record settling = record(0.5, 0.15, 0.1);
  const auto result = find_settling(*Frequency::parse("80"), settling.stamps_ns, settling.values);
  ASSERT_TRUE(result.has_value());
  EXPECT_GT(result->settling_s, 0.2);
  EXPECT_LT(result->settling_s, 0.8);
}

TEST(Settling, SaysSoWhenTheRecordNeverSettles) {
  const Record drifting = record(0.5, 10.0, 1e-5);
  EXPECT_EQ(
      find_settling(*Frequency::parse("80"), drifting.stamps_ns, drifting.values).error().code,
      ErrorCode::not_converged);
  const Record brief = record(0.0, 1.0, 1e-5, 0.05);
  EXPECT_EQ(find_settling(*Frequency::parse("80"), brief.stamps_ns, brief.values).error().code,
            ErrorCode::too_few_samples);
}

} // namespace
} // namespace dyncal::analysis
