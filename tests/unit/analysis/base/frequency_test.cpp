#include "analysis/base/frequency.hpp"

#include <cmath>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

__extension__ typedef __int128 Wide;

// Turns of `millihertz` over dt, by integers: dt * mHz / 1e12, reduced to [-0.5, 0.5].
double turns_by_integers(std::int64_t millihertz, std::int64_t dt_ns) {
  const Wide period = 1'000'000'000'000;
  Wide rest = Wide{dt_ns} * millihertz % period;
  if (rest > period / 2) {
    rest -= period;
  }
  if (rest < -period / 2) {
    rest += period;
  }
  return static_cast<double>(static_cast<std::int64_t>(rest)) / 1e12;
}

double turn_distance(double a, double b) {
  return std::abs(std::remainder(a - b, 1.0));
}

TEST(Frequency, KeepsTheDecimalsThatADoubleLoses) {
  const auto exact = Frequency::parse("199.87");
  ASSERT_TRUE(exact);
  const std::int64_t six_hours = 21'600'000'000'001;
  EXPECT_LT(turn_distance(exact->reduced_turns(six_hours), turns_by_integers(199'870, six_hours)),
            2e-16);
  // The nearest double is about 5e-11 turns away from the decimal by then.
  EXPECT_GT(turn_distance(Frequency::from_hz(199.87).reduced_turns(six_hours),
                          turns_by_integers(199'870, six_hours)),
            1e-12);
}

TEST(Frequency, ReducesAnyDifferenceOfStamps) {
  for (const std::int64_t millihertz : {1LL, 997LL, 12'500LL, 46'700LL, 199'870LL, 10'000'000LL}) {
    const std::string text = std::to_string(millihertz) + "e-3";
    const auto frequency = Frequency::parse(text);
    ASSERT_TRUE(frequency) << text;
    std::int64_t dt = 1;
    for (int i = 0; i < 60; ++i, dt = dt * 2 + i % 3) {
      EXPECT_LT(turn_distance(frequency->reduced_turns(dt), turns_by_integers(millihertz, dt)),
                2.3e-16)
          << text << ' ' << dt;
      EXPECT_EQ(frequency->reduced_turns(-dt), -frequency->reduced_turns(dt)) << text << ' ' << dt;
    }
    EXPECT_LT(turn_distance(frequency->reduced_turns(1'700'000'000'123'456'789),
                            turns_by_integers(millihertz, 1'700'000'000'123'456'789)),
              2.3e-16);
  }
}

TEST(Frequency, ReadsEveryCommonDecimalForm) {
  EXPECT_EQ(Frequency::parse("12.5")->hz(), 12.5);
  EXPECT_EQ(Frequency::parse("1e3")->hz(), 1000.0);
  EXPECT_EQ(Frequency::parse("+0.0125E+3")->hz(), 12.5);
  EXPECT_EQ(Frequency::parse(".5")->hz(), 0.5);
  EXPECT_EQ(Frequency::parse("80.")->hz(), 80.0);
  EXPECT_EQ(Frequency::parse("000080.000")->hz(), 80.0);
  EXPECT_EQ(Frequency::parse("0.1000000000000000055511151231257827021181583404541015625")->hz(),
            0.1);
  EXPECT_EQ(Frequency::parse("46.7")->turns_per_ns_high(), 46.7e-9);
}

TEST(Frequency, RefusesWhatIsNoNumber) {
  for (const char* text : {"", " 80", "80 ", "80Hz", "8,5", ".", "-", "e3", "1e", "1e+", "0x10",
                           "nan", "inf", "1.2.3"}) {
    const auto frequency = Frequency::parse(text);
    ASSERT_FALSE(frequency) << text;
    EXPECT_EQ(frequency.error().code, ErrorCode::invalid_argument) << text;
  }
}

TEST(Frequency, RefusesZeroNegativeAndAbsurdValues) {
  for (const char* text : {"0", "-80", "0.000", "1e99", "1e-99", "1e99999999999"}) {
    const auto frequency = Frequency::parse(text);
    ASSERT_FALSE(frequency) << text;
    EXPECT_EQ(frequency.error().code, ErrorCode::frequency_out_of_range) << text;
  }
}

TEST(Frequency, GivesBackTheDoubleItWasMadeOf) {
  for (const double hz : {80.0, 199.87, 1.0 / 3.0, 9999.123456789, 1e-3}) {
    EXPECT_EQ(Frequency::from_hz(hz).hz(), hz);
    EXPECT_NEAR(Frequency::from_hz(hz).angular(), 6.283185307179586 * hz, 4e-16 * 6.3 * hz);
  }
}

TEST(Frequency, ShiftsBySmallAmountsWithoutLosingThem) {
  const auto start = Frequency::parse("199.87");
  const Frequency shifted =
      start->shifted_by_hz(1e-17); // far below the double's last place at 199.87
  EXPECT_EQ(shifted.hz(), start->hz());
  const std::int64_t day = 86'400'000'000'000;
  EXPECT_NEAR(std::remainder(shifted.reduced_turns(day) - start->reduced_turns(day), 1.0),
              1e-17 * 86'400.0, 2e-16);
  EXPECT_NEAR(start->shifted_by_hz(-0.5).hz(), 199.37, 1e-13);
}

} // namespace
} // namespace dyncal::analysis
