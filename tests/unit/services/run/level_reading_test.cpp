// The whole loop without a network: what the reference shows as samples, what is read from them,
// and which voltage follows. Bad references never drive the exciter far beyond the highest level;
// good ones bring it to its level.
#include "services/run/level_reading.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/generator/level_control.hpp"
#include "services/evaluation/record/channel_level.hpp"

namespace dyncal::inline run {
namespace {

using drivers::generator::LevelControl;
using drivers::generator::LevelLimits;
using testing::AnyOf;
using testing::HasSubstr;

constexpr double rate_hz = 5000.0;
constexpr double level_per_volt = 50.0;
constexpr double planned_m_s2 = 50.0;
constexpr double tolerance_rel = 0.05;
constexpr double mains_hz = 50.0;

double turn(double cycles) {
  return 2.0 * std::numbers::pi * cycles;
}

struct Bench {
  std::string frequency_hz = "80";
  double gain = 1.0;       // of the exciter, in level_per_volt
  double range_m_s2 = 0.0; // as described; 0: not known
  std::function<double(double motion, double t_s)> shown = [](double motion, double) {
    return motion;
  };
};

SourceRecord record_of(const Bench& bench, double level_m_s2) {
  SourceRecord record("acs");
  drivers::SourceDescription description;
  description.channels.resize(1);
  description.channels[0].name = "reference";
  description.channels[0].minimum = -bench.range_m_s2;
  description.channels[0].maximum = bench.range_m_s2;
  record.describe(description);
  const double frequency_hz = std::stod(bench.frequency_hz);
  std::vector<double> values;
  std::vector<std::int64_t> stamps_ns;
  for (int i = 0; i <= static_cast<int>(rate_hz * level_window_s(frequency_hz)); ++i) {
    const double t_s = i / rate_hz;
    const double shown = bench.shown(level_m_s2 * std::sin(turn(frequency_hz * t_s)), t_s);
    values.push_back(bench.range_m_s2 > 0.0 ? std::clamp(shown, -bench.range_m_s2, bench.range_m_s2)
                                            : shown);
    stamps_ns.push_back(std::llround(1e9 * t_s));
  }
  SourceBlock block;
  block.session = 1;
  block.samples = values.size();
  block.channels = 1;
  block.stamps_ns = stamps_ns;
  block.values = values;
  record.add(block);
  return record;
}

Expected<LevelReading> read(const Bench& bench, double level_m_s2) {
  const SourceRecord record = record_of(bench, level_m_s2);
  return read_level(record, 0, {record.stamps_ns().front(), record.stamps_ns().back()},
                    *analysis::Frequency::parse(bench.frequency_hz), 0.5 * tolerance_rel);
}

struct Outcome {
  std::string refused; // empty: the level was reached
  double level_m_s2 = 0.0;
  double highest_m_s2 = 0.0;
};

Outcome run_loop(const Bench& bench, double maximum_m_s2, bool is_stated) {
  Outcome outcome;
  LevelLimits limits;
  if (is_stated) {
    limits.maximum_level_m_s2 = maximum_m_s2;
  }
  limits.plausible_level_m_s2 = drivers::generator::plausible_level_m_s2(maximum_m_s2);
  limits.plausible_voltage_v = limits.plausible_level_m_s2 / level_per_volt;
  auto loop = LevelControl::start({.level_m_s2 = planned_m_s2,
                                   .tolerance_rel = tolerance_rel,
                                   .level_per_volt = level_per_volt,
                                   .corrections = 3},
                                  limits)
                  .value();
  for (;;) {
    outcome.level_m_s2 = loop.voltage_v() * level_per_volt * bench.gain;
    outcome.highest_m_s2 = std::max(outcome.highest_m_s2, outcome.level_m_s2);
    const auto reading = read(bench, outcome.level_m_s2);
    if (!reading || !reading->level_m_s2) {
      outcome.refused = reading ? reading->lacking : reading.error().message;
      return outcome;
    }
    const auto reached = loop.take(*reading->level_m_s2);
    if (!reached || *reached) {
      outcome.refused = reached ? "" : reached.error().message;
      return outcome;
    }
  }
}

class Draws {
public:
  explicit Draws(unsigned seed) : random_(seed) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double logarithmic(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  }
  std::string frequency_hz() {
    static const std::vector<std::string> frequencies{"16", "40", "47", "50", "51", "80", "163"};
    return frequencies[std::uniform_int_distribution<std::size_t>(0, 6)(random_)];
  }
  std::mt19937& random() { return random_; }

private:
  std::mt19937 random_;
};

// Bad in one of seven ways.
Bench bad_reference(int kind, Draws& draws) {
  Bench bench{.frequency_hz = draws.frequency_hz(), .range_m_s2 = 100.0};
  const double end = bench.range_m_s2 * draws.between(0.1, 0.9);
  const double hum = planned_m_s2 * draws.logarithmic(0.3, 3.0);
  const double phase = draws.between(0.0, 1.0);
  const auto humming = [=](double motion, double t_s) {
    return motion + hum * std::sin(turn(mains_hz * t_s + phase));
  };
  switch (kind) {
  case 0: // within the range that it states
    bench.shown = [=](double motion, double) { return std::clamp(motion, -end, end); };
    break;
  case 1:
    bench.range_m_s2 = end;
    break;
  case 2:
    bench.shown = [=](double motion, double) { return std::min(motion, 0.3 * end); };
    break;
  case 3:
    bench.shown = humming;
    break;
  case 4: // and the exciter is off
    bench.shown = [=](double, double t_s) { return humming(0.0, t_s); };
    break;
  case 5:
    bench.shown = [](double, double) { return 0.0; };
    break;
  default:
    bench.shown = [&random = draws.random(), hum](double, double) {
      return std::normal_distribution<double>(0.0, hum)(random);
    };
  }
  return bench;
}

TEST(LevelLoop, ABadReferenceNeverDrivesTheExciterFarBeyondTheHighestLevel) {
  Draws draws(32);
  int refused = 0;
  for (int draw = 0; draw < 140; ++draw) {
    const bool is_stated = draws.between(0.0, 1.0) < 0.5;
    const double maximum_m_s2 = is_stated ? planned_m_s2 * draws.between(1.0, 2.5) : planned_m_s2;
    const Bench bench = bad_reference(draw % 7, draws);
    const Outcome outcome = run_loop(bench, maximum_m_s2, is_stated);
    EXPECT_LE(outcome.highest_m_s2, 1.5 * maximum_m_s2 * (1.0 + 1e-9)) << "draw " << draw;
    refused += outcome.refused.empty() ? 0 : 1;
    if (draw % 7 >= 4) {
      EXPECT_NE(outcome.refused, "") << "draw " << draw << ": there is no motion at all";
    }
  }
  EXPECT_GT(refused, 70);
}

TEST(LevelLoop, AGoodReferenceBringsTheExciterToItsLevelOrNamesTheKey) {
  Draws draws(33);
  int reached = 0;
  for (int draw = 0; draw < 80; ++draw) {
    Bench bench{.frequency_hz = draws.frequency_hz(),
                .gain = draw % 2 == 0 ? draws.between(0.7, 5.0) : draws.between(0.2, 0.7),
                .range_m_s2 = 500.0};
    const double sign = draws.between(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
    const double noise = draws.between(0.0, 1.0);
    bench.shown = [=, &draws](double motion, double) {
      return sign * motion + std::normal_distribution<double>(0.0, noise)(draws.random());
    };
    const double maximum_m_s2 = planned_m_s2 * draws.between(1.0, 6.0);
    const Outcome outcome = run_loop(bench, maximum_m_s2, true);
    if (outcome.refused.empty()) {
      ++reached;
      EXPECT_NEAR(outcome.level_m_s2, planned_m_s2, 1.1 * tolerance_rel * planned_m_s2);
    } else {
      EXPECT_THAT(outcome.refused, HasSubstr("generator.level_per_volt"));
    }
    const bool cap_allows = bench.gain > planned_m_s2 / (1.49 * maximum_m_s2) &&
                            0.5 * bench.gain * planned_m_s2 < 0.99 * maximum_m_s2;
    EXPECT_EQ(outcome.refused.empty() || !cap_allows, true)
        << "draw " << draw << ", gain " << bench.gain << ": " << outcome.refused;
  }
  EXPECT_GT(reached, 40);
}

TEST(LevelLoop, WithoutAMaximumALevelBeyondTheHighestPlannedNamesTheKey) {
  const Outcome outcome = run_loop({.gain = 4.0}, planned_m_s2, false);
  EXPECT_THAT(outcome.refused, HasSubstr("is generator.level_per_volt right"));
}

TEST(LevelReading, OfAReferenceThatHumsBesideAnExciterThatIsOffSaysSo) {
  const Bench bench{.frequency_hz = "81", .shown = [](double, double t_s) {
                      return 40.0 * std::sin(turn(mains_hz * t_s));
                    }};
  const auto reading = read(bench, 25.0).value();
  EXPECT_FALSE(reading.level_m_s2);
  EXPECT_THAT(reading.lacking, HasSubstr("are at 81 Hz: does it hum, or is the exciter off?"));
}

TEST(LevelReading, StandsBesideHumThatIsSmaller) {
  const Bench bench{.shown = [](double motion, double t_s) {
    return motion + 12.0 * std::sin(turn(mains_hz * t_s));
  }};
  const auto reading = read(bench, 25.0).value();
  ASSERT_TRUE(reading.level_m_s2) << reading.lacking;
  EXPECT_NEAR(*reading.level_m_s2, 25.0, 0.3);
}

TEST(LevelReading, WaitsForALevelThatMoves) {
  const Bench bench{.shown = [](double motion, double t_s) { return motion * (1.0 + t_s); }};
  const auto reading = read(bench, 25.0).value();
  EXPECT_FALSE(reading.level_m_s2);
  EXPECT_THAT(reading.lacking, HasSubstr("settling_s"));
}

TEST(LevelReading, RefusesAWindowAtAnEndOfTheRange) {
  const auto reading = read({.range_m_s2 = 20.0}, 25.0);
  ASSERT_FALSE(reading);
  EXPECT_THAT(reading.error().message, HasSubstr("acs/reference is at an end of its range"));
}

} // namespace
} // namespace dyncal::inline run
