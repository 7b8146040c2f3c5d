#include "drivers/generator/level_control.hpp"

#include <algorithm>
#include <random>

#include <gmock/gmock.h>

namespace dyncal::drivers::generator {
namespace {

using ::testing::HasSubstr;

// Runs the loop on an exciter; returns the last voltage, and what the table did at most.
struct Outcome {
  Expected<bool> done = false;
  double voltage_v = 0.0;
  double max_m_s2 = 0.0;
  int measurements = 0;
};

template <class Exciter>
Outcome control(const LevelTarget& target, const LevelLimits& limits, Exciter exciter) {
  Outcome outcome;
  auto loop = LevelControl::start(target, limits);
  if (!loop) {
    outcome.done = fail(loop.error());
    return outcome;
  }
  do {
    outcome.voltage_v = loop->voltage_v();
    EXPECT_LE(outcome.voltage_v, limits.maximum_voltage_v);
    const double level = exciter(outcome.voltage_v);
    outcome.max_m_s2 = std::max(outcome.max_m_s2, level);
    ++outcome.measurements;
    outcome.done = loop->take(level);
  } while (outcome.done && !*outcome.done);
  return outcome;
}

TEST(LevelControl, ReachesTheLevelOfALinearExciterWithOneCorrection) {
  const auto outcome = control({.level_m_s2 = 10.0, .tolerance_rel = 0.005, .level_per_volt = 50.0},
                               {}, [](double v) { return 37.0 * v; });
  ASSERT_TRUE(outcome.done) << outcome.done.error().message;
  EXPECT_NEAR(outcome.voltage_v, 10.0 / 37.0, 1e-12);
  EXPECT_EQ(outcome.measurements, 2);
}

TEST(LevelControl, AResponseThatIsKnownIsUsedInFull) {
  const auto outcome = control({.level_m_s2 = 10.0, .level_per_volt = 37.0, .response_known = true},
                               {}, [](double v) { return 37.0 * v; });
  ASSERT_TRUE(outcome.done);
  EXPECT_EQ(outcome.measurements, 1);
}

TEST(LevelControl, FollowsAnExciterThatSaturates) {
  const auto outcome = control(
      {.level_m_s2 = 100.0, .tolerance_rel = 0.01, .level_per_volt = 50.0, .corrections = 6}, {},
      [](double v) { return 50.0 * v / (1.0 + 0.1 * v); });
  ASSERT_TRUE(outcome.done) << outcome.done.error().message;
  EXPECT_NEAR(50.0 * outcome.voltage_v / (1.0 + 0.1 * outcome.voltage_v), 100.0, 1.0);
}

TEST(LevelControl, NeverReturnsAVoltageAboveTheLimit) {
  const auto outcome = control({.level_m_s2 = 10.0, .level_per_volt = 50.0},
                               {.maximum_voltage_v = 0.5}, [](double v) { return 10.0 * v; });
  ASSERT_FALSE(outcome.done);
  EXPECT_THAT(outcome.done.error().message,
              HasSubstr("needs 1 V, above generator.maximum_voltage_v = 0.5"));
  EXPECT_LE(outcome.voltage_v, 0.5);
}

TEST(LevelControl, AnExciterFarMoreLivelyThanStatedIsStoppedAtTheHighestLevel) {
  const auto outcome = control({.level_m_s2 = 10.0, .level_per_volt = 50.0},
                               {.maximum_level_m_s2 = 12.0}, [](double v) { return 200.0 * v; });
  ASSERT_FALSE(outcome.done);
  EXPECT_EQ(outcome.measurements, 1);
  EXPECT_THAT(outcome.done.error().message, HasSubstr("above generator.maximum_level_m_s2 = 12"));
}

TEST(LevelControl, AReferenceThatShowsNothingIsNoReasonForMoreVoltage) {
  const auto outcome =
      control({.level_m_s2 = 10.0, .level_per_volt = 50.0}, {}, [](double) { return 0.002; });
  ASSERT_FALSE(outcome.done);
  EXPECT_EQ(outcome.measurements, 1);
  EXPECT_THAT(outcome.done.error().message, HasSubstr("is the amplifier on"));
}

TEST(LevelControl, GivesUpOnAnExciterThatIsNeverTheSame) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> gain(30.0, 70.0);
  const auto outcome = control({.level_m_s2 = 10.0, .tolerance_rel = 1e-4, .level_per_volt = 50.0},
                               {}, [&](double v) { return gain(random) * v; });
  ASSERT_FALSE(outcome.done);
  EXPECT_EQ(outcome.measurements, 5);
  EXPECT_THAT(outcome.done.error().message, HasSubstr("after 4 corrections"));
}

// Whatever gain the exciter has, and wherever the reference ends.
TEST(LevelControl, AReferenceThatEndsAtItsRangeNeverDrivesFarBeyondTheHighestLevel) {
  std::mt19937 random(32);
  std::uniform_real_distribution<double> factor(0.7, 5.0), end(0.2, 0.95);
  int refused = 0;
  for (int draw = 0; draw < 200; ++draw) {
    const double gain = 50.0 * factor(random);
    const double range = 50.0 * end(random);
    double largest_v = 0.0;
    const auto outcome =
        control({.level_m_s2 = 50.0, .tolerance_rel = 0.01, .level_per_volt = 50.0},
                {.maximum_level_m_s2 = 120.0, .plausible_voltage_v = 3.6}, [&](double v) {
                  largest_v = std::max(largest_v, v);
                  return std::min(gain * v, range);
                });
    refused += outcome.done ? 0 : 1;
    EXPECT_LE(largest_v, 1.5 * 120.0 / 50.0);
  }
  EXPECT_EQ(refused, 200);
}

TEST(LevelControl, AnExciterOfAnotherGainThanStatedReachesItsLevel) {
  std::mt19937 random(33);
  std::uniform_real_distribution<double> factor(0.7, 2.3);
  for (int draw = 0; draw < 200; ++draw) {
    const double gain = 50.0 * factor(random);
    const auto outcome =
        control({.level_m_s2 = 50.0, .tolerance_rel = 0.01, .level_per_volt = 50.0},
                {.maximum_level_m_s2 = 60.0, .plausible_voltage_v = 1.8},
                [&](double v) { return gain * v; });
    ASSERT_TRUE(outcome.done) << outcome.done.error().message;
    EXPECT_NEAR(gain * outcome.voltage_v, 50.0, 0.5);
  }
}

TEST(LevelControl, AnExciterFarLazierThanStatedIsRefusedByTheKeyThatSaysSo) {
  const auto outcome = control({.level_m_s2 = 50.0, .level_per_volt = 50.0},
                               {.maximum_level_m_s2 = 60.0, .plausible_voltage_v = 1.8},
                               [](double v) { return 15.0 * v; });
  ASSERT_FALSE(outcome.done);
  EXPECT_THAT(outcome.done.error().message, HasSubstr("is generator.level_per_volt right"));
  EXPECT_LE(outcome.voltage_v, 1.8);
}

TEST(LevelControl, ALevelAboveTheHighestIsRefusedBeforeAnythingIsSet) {
  EXPECT_FALSE(LevelControl::start({.level_m_s2 = 20.0, .level_per_volt = 50.0},
                                   {.maximum_level_m_s2 = 15.0}));
  EXPECT_FALSE(voltage_for_level(20.0, 50.0, {.maximum_voltage_v = 0.3}));
  EXPECT_FALSE(
      LevelControl::start({.level_m_s2 = 20.0, .tolerance_rel = 0.0, .level_per_volt = 50.0}, {}));
  EXPECT_TRUE(
      voltage_for_level(15.0, 50.0, {.maximum_voltage_v = 0.3, .maximum_level_m_s2 = 15.0}));
}

} // namespace
} // namespace dyncal::drivers::generator
