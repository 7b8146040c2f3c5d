#include "drivers/smartup/stamp_check.hpp"

#include <cmath>
#include <functional>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "drivers/sample_block.hpp"

namespace dyncal::drivers::smartup {
namespace {

constexpr std::int64_t start_ns = 1'600'000'000'000'000'000;
constexpr std::int64_t second_ns = 1'000'000'000;

// A sensor with a true stamp for every sample; faults are added to single samples.
class SimulatedSensor {
public:
  explicit SimulatedSensor(double period_ns) : period_ns_(period_ns) {}

  // Flags of the next sample, whose stamp is off by `error_ns`.
  std::uint8_t next(std::int64_t error_ns = 0, std::uint32_t uncertainty_ns = 84) {
    ++sample_;
    const auto offset_ns =
        static_cast<std::int64_t>(std::llround(static_cast<double>(sample_) * period_ns_));
    last_ns_ = start_ns + offset_ns + error_ns;
    return check_.check({sample_, last_ns_, uncertainty_ns, false});
  }

  // Flags seen in `count` samples with the same error.
  std::map<int, int> run(int count, std::int64_t error_ns = 0) {
    std::map<int, int> flags;
    for (int i = 0; i < count; ++i) {
      ++flags[next(error_ns)];
    }
    return flags;
  }

  std::uint8_t repeat() { return check_.check({++sample_, last_ns_, 44, false}); }
  std::uint8_t no_fix() { return check_.check({++sample_, 123456, 0, true}); }
  void skip(std::uint64_t samples) { sample_ += samples; }
  [[nodiscard]] double period_ns() const { return check_.period_ns(); }

private:
  double period_ns_;
  std::uint64_t sample_ = 0;
  std::int64_t last_ns_ = 0;
  StampCheck check_;
};

using Flags = std::map<int, int>;

TEST(StampCheck, TrustsAnExactSensor) {
  SimulatedSensor sensor(996959.9);
  EXPECT_EQ(sensor.run(20000), (Flags{{0, 20000}}));
  EXPECT_NEAR(sensor.period_ns(), 996959.9, 0.01);
}

TEST(StampCheck, TrustsTheJitterOfAnMpu9250) {
  SimulatedSensor sensor(996960);
  std::mt19937 random(1);
  std::normal_distribution<double> jitter_ns(0, 21);
  for (int i = 0; i < 50000; ++i) {
    const bool late = i % 1000 == 999;
    ASSERT_EQ(sensor.next(std::llround(jitter_ns(random)) + (late ? 335 : 0)), 0) << i;
  }
}

TEST(StampCheck, TrustsLateAndEarlyPairs) {
  for (const std::int64_t late_ns : {4200, 20000, 60000}) {
    SimulatedSensor sensor(485000);
    for (int i = 0; i < 50000; ++i) {
      ASSERT_EQ(sensor.next(i % 2200 == 2199 ? late_ns : 0), 0) << i;
    }
  }
}

TEST(StampCheck, TrustsASensorThatIsPacedBySoftware) {
  SimulatedSensor sensor(10e6);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> jitter_ns(-800e3, 800e3);
  for (int i = 0; i < 5000; ++i) {
    ASSERT_EQ(sensor.next(std::llround(jitter_ns(random))), 0) << i;
  }
}

TEST(StampCheck, TrustsASlowSensor) {
  SimulatedSensor sensor(3.050023e9);
  EXPECT_EQ(sensor.run(500), (Flags{{0, 500}}));
}

TEST(StampCheck, TrustsAClockThatDriftsWithTemperature) {
  StampCheck check;
  double stamp_ns = 0;
  for (std::uint64_t n = 1; n <= 200000; ++n) {
    stamp_ns +=
        1e6 * (1.0 + 2e-3 * std::sin(static_cast<double>(n) / 20000.0)); // +-0.2 % over minutes
    ASSERT_EQ(check.check({n, start_ns + std::llround(stamp_ns), 84, false}), 0) << n;
  }
}

TEST(StampCheck, TrustsWhatComesAfterALoss) {
  SimulatedSensor sensor(996960);
  (void)sensor.run(5000);
  sensor.skip(30000);
  EXPECT_EQ(sensor.run(1000), (Flags{{0, 1000}}));
}

TEST(StampCheck, RecognisesAMislabelledSecond) {
  for (const std::int64_t slip_ns : {second_ns, -second_ns}) {
    SimulatedSensor sensor(996960);
    (void)sensor.run(2000);
    EXPECT_EQ(sensor.run(3000, slip_ns), (Flags{{stamp_second_slip, 3000}}));
    EXPECT_EQ(sensor.run(2000), (Flags{{0, 2000}}));
  }
}

TEST(StampCheck, RecognisesTheExtensionOfTheCounter) {
  for (const double rate_hz : {108e6, 100e6}) {
    SimulatedSensor sensor(996960);
    (void)sensor.run(2000);
    const auto error_ns = static_cast<std::int64_t>(4294967296.0 / (rate_hz * (1 + 3.1e-6)) * 1e9);
    EXPECT_EQ(sensor.next(error_ns), stamp_counter_extension);
    EXPECT_EQ(sensor.run(100), (Flags{{0, 100}}));
    EXPECT_EQ(sensor.next(-error_ns), stamp_counter_extension);
    EXPECT_EQ(sensor.run(100), (Flags{{0, 100}}));
  }
}

TEST(StampCheck, RecognisesTornHalvesOfTheCounter) {
  for (const double period_ns : {996960.0, 485000.0, 125000.0}) {
    SimulatedSensor sensor(period_ns);
    (void)sensor.run(2000);
    EXPECT_EQ(sensor.next(606815), stamp_torn_counter) << period_ns;
    EXPECT_EQ(sensor.next(), 0);
    EXPECT_EQ(sensor.next(-606815), stamp_torn_counter) << period_ns;
    EXPECT_EQ(sensor.run(100), (Flags{{0, 100}}));
  }
}

TEST(StampCheck, RecognisesTheOffsetOfAnExtraPulse) {
  for (const std::int64_t offset_ns : {198'000'000, -12'000'000, 700'000}) {
    SimulatedSensor sensor(996960);
    (void)sensor.run(2000);
    auto flags = sensor.run(1000, offset_ns);
    EXPECT_EQ(flags[0], 0) << offset_ns;
    EXPECT_GE(flags[stamp_offset_below_second], 999)
        << offset_ns; // the first of an early stretch runs backwards
    EXPECT_EQ(sensor.run(2000), (Flags{{0, 2000}}));
  }
}

TEST(StampCheck, RecognisesARepeatedStamp) {
  SimulatedSensor sensor(996960);
  (void)sensor.run(2000);
  EXPECT_EQ(sensor.repeat(), stamp_repeated);
  EXPECT_EQ(sensor.repeat(), stamp_repeated);
  EXPECT_EQ(sensor.run(100), (Flags{{0, 100}}));
}

TEST(StampCheck, RecognisesMissingUncertaintyBesideOtherFaults) {
  SimulatedSensor sensor(996960);
  EXPECT_EQ(sensor.next(0, 0), stamp_no_uncertainty);
  (void)sensor.run(2000);
  EXPECT_EQ(sensor.next(0, 0), stamp_no_uncertainty);
  EXPECT_EQ(sensor.next(second_ns, 0), stamp_no_uncertainty | stamp_second_slip);
}

TEST(StampCheck, RecognisesAUnitWithoutFix) {
  SimulatedSensor sensor(996960);
  (void)sensor.run(100);
  EXPECT_EQ(sensor.no_fix() & stamp_no_fix, stamp_no_fix);
  EXPECT_EQ(sensor.run(100), (Flags{{0, 100}}));
}

TEST(StampCheck, RecognisesStampsThatRunBackwards) {
  SimulatedSensor sensor(996960);
  (void)sensor.run(100);
  EXPECT_EQ(sensor.next(-7'300'000'000), stamp_backwards);
  EXPECT_EQ(sensor.run(100), (Flags{{0, 100}}));
}

TEST(StampCheck, AcceptsAChangeThatLasts) {
  SimulatedSensor sensor(996960);
  (void)sensor.run(2000);
  auto flags = sensor.run(20000, second_ns);
  EXPECT_NEAR(flags[stamp_second_slip], 10030, 20); // ten seconds
  EXPECT_EQ(sensor.run(1000, second_ns), (Flags{{0, 1000}}));
  EXPECT_GE(sensor.run(100).at(stamp_second_slip), 100); // and back is a slip again
}

TEST(StampCheck, APauseOfTheUnitCostsOneSample) {
  SimulatedSensor sensor(996960);
  (void)sensor.run(2000);
  EXPECT_EQ(sensor.run(2000, 37'123'000'000), (Flags{{0, 1999}, {stamp_offset_below_second, 1}}));
}

// The unit numbers what is left: the stamps alone show it. Each loss costs one sample more.
TEST(StampCheck, ALossThatNumbersDoNotShowCostsOneSample) {
  constexpr double period_ns = 996'960.0;
  StampCheck check;
  std::mt19937 random(4);
  std::normal_distribution<double> jitter_ns(0, 21);
  std::uint64_t number = 0;
  int losses = 0, flagged = 0;
  for (int i = 0; i < 50'000; ++i) {
    if (i > 100 && random() % 500 == 0) {
      i += static_cast<int>(random() % 3); // one to three
      ++losses;
      continue;
    }
    const auto stamp_ns = start_ns + std::llround(period_ns * i) + std::llround(jitter_ns(random));
    flagged += check.check({++number, stamp_ns, 84, false}) == 0 ? 0 : 1;
  }
  EXPECT_GT(losses, 50);
  EXPECT_LE(flagged, losses + 2); // and one where two meet
  EXPECT_GE(flagged, losses - 5);
  EXPECT_NEAR(check.period_ns(), period_ns, 1.0);
}

TEST(StampCheck, FindsItsModelThoughAFaultIsAmongTheFirstStamps) {
  SimulatedSensor sensor(996960);
  (void)sensor.next();
  (void)sensor.next(second_ns);
  (void)sensor.run(20);
  EXPECT_EQ(sensor.run(1000), (Flags{{0, 1000}}));
}

TEST(StampCheck, FollowsASensorWhoseRateIsChanged) {
  StampCheck check;
  std::int64_t stamp_ns = start_ns;
  std::uint64_t n = 0;
  for (int i = 0; i < 2000; ++i) {
    (void)check.check({++n, stamp_ns += 1'000'000, 84, false});
  }
  for (int i = 0; i < 40000; ++i) {
    (void)check.check({++n, stamp_ns += 500'000, 84, false});
  }
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(check.check({++n, stamp_ns += 500'000, 84, false}), 0);
  }
  EXPECT_NEAR(check.period_ns(), 500'000, 1);
}

TEST(StampCheck, EveryFlagHasAName) {
  for (std::size_t bit = 0; bit < stamp_flag_count; ++bit) {
    EXPECT_GT(std::string(to_string(static_cast<StampFlag>(1U << bit))).size(), 8U);
  }
}

} // namespace
} // namespace dyncal::drivers::smartup
