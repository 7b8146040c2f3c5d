#include "analysis/clock/pulse_clock.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::int64_t begin_s = 1'760'000'000;

// Of an instrument whose rate is 3e-6 off, pulses with a scatter; what its samples' times are.
class Instrument {
public:
  Instrument(double jitter_s, std::uint64_t seed) : jitter_s_(jitter_s), generator_(seed) {}

  [[nodiscard]] double place_of(double second) const { return 4321.7 + rate * second; }
  [[nodiscard]] double error_s(const PulseClock& clock, std::uint64_t sample) const {
    const double second = (static_cast<double>(sample) - 4321.7) / rate;
    return static_cast<double>(clock.utc_ns(sample) - begin_s * second_ns) * 1e-9 - second;
  }
  PulseClock::Answer add(PulseClock& clock, double second, double host_late_s = 0.1) {
    const double place = place_of(second + jitter_s_ * noise_(generator_));
    const double whole = std::floor(place);
    return clock.add({static_cast<std::uint64_t>(whole), place - whole, 0.0},
                     begin_s * second_ns + std::llround((second + host_late_s) * 1e9));
  }
  void add_each_second(PulseClock& clock, int first, int behind) {
    for (int second = first; second < behind; ++second) {
      add(clock, second);
    }
  }

  static constexpr double rate = 20000.0 * (1.0 + 3e-6);

private:
  double jitter_s_;
  std::mt19937_64 generator_;
  std::normal_distribution<double> noise_;
};

TEST(PulseClock, TellsUtcWithinItsUncertainty) {
  double squares = 0.0;
  int covered = 0;
  constexpr int draws = 400;
  for (int draw = 0; draw < draws; ++draw) {
    Instrument instrument(50e-9, static_cast<std::uint64_t>(draw) + 1);
    PulseClock clock(20000.0);
    instrument.add_each_second(clock, 0, 40);
    ASSERT_TRUE(clock.is_known());
    const auto sample = static_cast<std::uint64_t>(instrument.place_of(39.5));
    const double error_s = instrument.error_s(clock, sample);
    squares += error_s * error_s;
    covered += std::abs(error_s) <= 2.0 * clock.u_s(sample) ? 1 : 0;
    EXPECT_NEAR(clock.since_pulse_s(sample), 0.5, 1e-3);
  }
  EXPECT_LT(std::sqrt(squares / draws), 30e-9); // of one pulse 50 ns
  EXPECT_GE(covered, draws * 93 / 100);
}

TEST(PulseClock, KnowsNothingBeforeEightPulses) {
  Instrument instrument(0.0, 1);
  PulseClock clock(20000.0);
  instrument.add_each_second(clock, 0, 7);
  EXPECT_FALSE(clock.is_known());
  instrument.add_each_second(clock, 7, 8);
  EXPECT_TRUE(clock.is_known());
}

TEST(PulseClock, TheSecondIsTheOneNearestToTheHostsTime) {
  for (const double late_s : {-0.45, 0.0, 0.45}) {
    Instrument instrument(0.0, 1);
    PulseClock clock(20000.0);
    for (int second = 0; second < 8; ++second) {
      instrument.add(clock, second, late_s);
    }
    EXPECT_NEAR(instrument.error_s(clock, 100'000), 0.0, 2e-9) << late_s;
  }
}

TEST(PulseClock, PulsesOffTheGridAreLeftOut) {
  Instrument instrument(50e-9, 3);
  PulseClock clock(20000.0);
  instrument.add_each_second(clock, 0, 20);
  EXPECT_EQ(instrument.add(clock, 20.37), PulseClock::Answer::left_out);
  EXPECT_EQ(instrument.add(clock, 21.0 + 2e-6), PulseClock::Answer::left_out);
  EXPECT_EQ(instrument.add(clock, 22.0), PulseClock::Answer::taken);
  EXPECT_NEAR(instrument.error_s(clock, 440'000), 0.0, 200e-9);
}

TEST(PulseClock, MissingPulsesAreBridgedWithAGrowingUncertainty) {
  Instrument instrument(20e-9, 4);
  PulseClock clock(20000.0);
  instrument.add_each_second(clock, 0, 32);
  const auto after = [&](double seconds) {
    return clock.u_s(static_cast<std::uint64_t>(instrument.place_of(31.0 + seconds)));
  };
  EXPECT_GT(after(30.0), 5.0 * after(1.0));
  EXPECT_EQ(instrument.add(clock, 90.0), PulseClock::Answer::taken);
}

TEST(PulseClock, ThreeOnAGridOfTheirOwnBeginAnew) {
  Instrument instrument(20e-9, 5);
  PulseClock clock(20000.0);
  instrument.add_each_second(clock, 0, 20);
  EXPECT_EQ(instrument.add(clock, 20.0 + 5e-6), PulseClock::Answer::left_out);
  EXPECT_EQ(instrument.add(clock, 21.0 + 5e-6), PulseClock::Answer::left_out);
  EXPECT_EQ(instrument.add(clock, 22.0 + 5e-6), PulseClock::Answer::moved);
  EXPECT_FALSE(clock.is_known());
  for (int second = 23; second < 28; ++second) {
    EXPECT_EQ(instrument.add(clock, second + 5e-6), PulseClock::Answer::taken);
  }
  EXPECT_TRUE(clock.is_known());
}

TEST(PulseClock, WhatAllPulsesShareStays) {
  PulseClock clock(20000.0);
  for (std::uint64_t second = 0; second < 20; ++second) {
    clock.add({second * 20000, 0.0, 0.289}, static_cast<std::int64_t>(second) * second_ns);
  }
  EXPECT_NEAR(clock.u_s(390'000), 0.289 / 20000.0, 1e-7);
}

} // namespace
} // namespace dyncal::analysis
