#include "services/evaluation/method/signal_check.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
};

// One second at 1 kS/s of 80 Hz with 1 % of the second harmonic and noise.
Record record(double amplitude, double noise) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, noise);
  Record made;
  for (int i = 0; i < 1000; ++i) {
    const double turn = 2.0 * std::numbers::pi * 80.0 * 1e-3 * i;
    made.stamps_ns.push_back(1'000'000LL * i);
    made.values.push_back(amplitude * (std::sin(turn) + 0.01 * std::sin(2.0 * turn)) +
                          normal(random));
  }
  return made;
}

SignalCheck check(const Record& made) {
  return check_signal("dau/z", analysis::measure_integrity(analysis::Frequency::from_hz(80.0),
                                                           made.stamps_ns, made.values, {}));
}

TEST(SignalCheck, GivesDistortionAndResidualAsNumbers) {
  const SignalCheck found = check(record(10.0, 0.05));
  EXPECT_EQ(found.signal.channel, "dau/z");
  EXPECT_NEAR(found.signal.thd, 0.01, 6.0 * found.signal.u_thd);
  EXPECT_GT(found.signal.u_thd, 0.0);
  EXPECT_NEAR(found.signal.residual, 0.005, 5e-4);
  EXPECT_NEAR(found.signal.over_noise, 1.0, 0.1);
  EXPECT_TRUE(found.flags.empty());
}

TEST(SignalCheck, SaysThatAStatedRangeCannotBeIt) {
  const Record made = record(10.0, 0.05);
  const SignalCheck found = check_signal(
      "dau/z", analysis::measure_integrity(analysis::Frequency::from_hz(80.0), made.stamps_ns,
                                           made.values, {.range_low = -1.0, .range_high = 1.0}));
  EXPECT_EQ(found.refusal, "");
  ASSERT_EQ(found.flags.size(), 1U);
  EXPECT_EQ(found.flags[0].kind, ResultFlag::signal_not_judged);
  EXPECT_THAT(found.flags[0].sentence, testing::HasSubstr("cannot be its range"));
}

TEST(SignalCheck, HasNoNumbersAndNoFlagWithoutASine) {
  const SignalCheck found = check(record(0.0, 0.05));
  EXPECT_TRUE(std::isnan(found.signal.thd));
  EXPECT_TRUE(std::isnan(found.signal.residual));
  EXPECT_TRUE(found.flags.empty());
}

TEST(SignalCheck, FlagsWhatItCannotJudge) {
  Record made = record(10.0, 0.05);
  made.stamps_ns[500] = made.stamps_ns[499];
  const SignalCheck found = check(made);
  EXPECT_TRUE(std::isnan(found.signal.thd));
  ASSERT_EQ(found.flags.size(), 1U);
  EXPECT_EQ(found.flags[0].kind, ResultFlag::signal_not_judged);
  EXPECT_THAT(found.flags[0].sentence, testing::StartsWith("dau/z: signal not judged: "));
}

} // namespace
} // namespace dyncal::inline evaluation
