#include "drivers/virtual_bench/model/stamp_faults.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr std::int64_t begin_ns = 1'600'000'000'000'000'000;
constexpr int samples = 20'000;

struct Outcome {
  std::vector<std::int64_t> errors_ns;
  std::vector<UnitSample> spoiled; // every sample as it came out
  int lost = 0;
};

Outcome apply(const StampFaultProbabilities& probabilities) {
  StampFaults faults(8, probabilities);
  Outcome outcome;
  for (int i = 0; i < samples; ++i) {
    UnitSample sample;
    sample.utc_ns = begin_ns + i * 1'000'000LL;
    sample.uncertainty_ns = 60;
    if (!faults.apply(sample)) {
      ++outcome.lost;
      continue;
    }
    outcome.errors_ns.push_back(sample.utc_ns - (begin_ns + i * 1'000'000LL));
    outcome.spoiled.push_back(sample);
  }
  return outcome;
}

int count_of(const Outcome& outcome, std::int64_t error_ns) {
  return static_cast<int>(std::count(outcome.errors_ns.begin(), outcome.errors_ns.end(), error_ns));
}

TEST(StampFaults, LeaveStampsAloneWhenNoneIsAskedFor) {
  EXPECT_EQ(count_of(apply({}), 0), samples);
}

TEST(StampFaults, SecondSlipIsExactlyOneSecondForAWhile) {
  const Outcome outcome = apply({{"second-slip", 1e-3}});
  const int late = count_of(outcome, 1'000'000'000);
  const int early = count_of(outcome, -1'000'000'000);
  EXPECT_EQ(count_of(outcome, 0) + late + early, samples);
  EXPECT_GT(late + early, 1000);
  EXPECT_GT(count_of(outcome, 0), 5000);
}

TEST(StampFaults, CounterExtensionIs39768MillisecondsForSingleSamples) {
  const Outcome outcome = apply({{"counter-extension", 0.01}});
  EXPECT_NEAR(count_of(outcome, 39'768'215'704), 200, 60); // 2^32 / 108 MHz
  EXPECT_EQ(count_of(outcome, 0) + count_of(outcome, 39'768'215'704), samples);
}

TEST(StampFaults, TornCounterIs607Microseconds) {
  const Outcome outcome = apply({{"torn-counter", 0.01}});
  EXPECT_NEAR(count_of(outcome, 606'815) + count_of(outcome, -606'815), 200, 60); // 2^16 / 108 MHz
}

TEST(StampFaults, PpsOffsetIsBelowASecondAndLastsLessThanASecond) {
  const Outcome outcome = apply({{"pps-offset", 1e-3}});
  int longest = 0;
  int run = 0;
  for (std::size_t i = 0; i < outcome.errors_ns.size(); ++i) {
    const std::int64_t error = outcome.errors_ns[i];
    ASSERT_LT(std::abs(error), 1'000'000'000);
    run = error != 0 && i > 0 && error == outcome.errors_ns[i - 1] ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  EXPECT_GT(longest, 20);
  EXPECT_LE(longest, 1000);
}

TEST(StampFaults, RepeatedHasTheTimeOfTheSampleBeforeAndATinyUncertainty) {
  const Outcome outcome = apply({{"repeated", 0.01}});
  int repeated = 0;
  for (std::size_t i = 1; i < outcome.spoiled.size(); ++i) {
    if (outcome.spoiled[i].utc_ns == outcome.spoiled[i - 1].utc_ns) {
      ++repeated;
      EXPECT_EQ(outcome.spoiled[i].uncertainty_ns, 0x2cU);
    }
  }
  EXPECT_NEAR(repeated, 200, 60);
}

TEST(StampFaults, NoUncertaintyNoFixAndLossAreAsLikelyAsAsked) {
  const Outcome outcome = apply({{"no-uncertainty", 0.02}, {"no-fix", 0.03}, {"unit-loss", 0.04}});
  EXPECT_NEAR(outcome.lost, 0.04 * samples, 120);
  const auto zero_uncertainty = std::count_if(outcome.spoiled.begin(), outcome.spoiled.end(),
                                              [](const auto& s) { return s.uncertainty_ns == 0; });
  const auto no_time = std::count_if(outcome.spoiled.begin(), outcome.spoiled.end(),
                                     [](const auto& s) { return s.utc_ns == 0; });
  EXPECT_NEAR(static_cast<double>(zero_uncertainty), 0.02 * samples, 100);
  EXPECT_NEAR(static_cast<double>(no_time), 0.03 * samples, 120);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
