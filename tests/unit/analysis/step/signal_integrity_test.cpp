#include "analysis/step/signal_integrity.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <random>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/uncertainty/found_resolution.hpp"

namespace dyncal::analysis {
namespace {

struct Sensor {
  double frequency_hz = 80.3;
  double amplitude = 10.0;
  double offset = 0.0;
  double noise = 0.02;
  double resolution = 9.80665 / 2048.0;
  double rate_hz = 1003.0;
  std::size_t samples = 3000;
  double limit = 1e9; // end stops, of both signs
  double second_harmonic = 0.0;
};

struct Series {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
};

Series series_of(const Sensor& sensor, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  const double phase = std::uniform_real_distribution<double>(-3.0, 3.0)(random);
  Series series;
  for (std::size_t i = 0; i < sensor.samples; ++i) {
    const double t = static_cast<double>(i) / sensor.rate_hz;
    const double angle = 2.0 * std::numbers::pi * sensor.frequency_hz * t + phase;
    double value = sensor.offset + sensor.amplitude * std::sin(angle) +
                   sensor.second_harmonic * std::sin(2.0 * angle + 0.4) +
                   sensor.noise * noise(random);
    if (sensor.resolution > 0.0) {
      value = sensor.resolution * std::round(value / sensor.resolution);
    }
    series.stamps_ns.push_back(static_cast<std::int64_t>(std::llround(t * 1e9)));
    series.values.push_back(std::clamp(value, -sensor.limit, sensor.limit));
  }
  return series;
}

SignalIntegrity integrity_of(const Sensor& sensor, const Series& series,
                             SignalExpectation expected = {}) {
  expected.resolution = sensor.resolution;
  const auto integrity = measure_integrity(Frequency::from_hz(sensor.frequency_hz),
                                           series.stamps_ns, series.values, expected);
  EXPECT_TRUE(integrity) << integrity.error().message;
  return integrity ? *integrity : SignalIntegrity{};
}

int runs() {
  const char* text = std::getenv("DYNCAL_COVERAGE_RUNS");
  return text ? std::stoi(text) : 1500;
}

// Amplitude in steps 1 to 3000, noise in steps 0 to 30, 40 to 4000 samples, rates that divide
// evenly and do not: nothing to be found.
TEST(SignalIntegrity, CleanSeriesRaiseNoAlarm) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::ostringstream which;
  int alarms = 0;
  int judged = 0;
  for (int run = 0; run < runs(); ++run) {
    Sensor sensor;
    sensor.amplitude = 1.0;
    sensor.resolution = run % 7 == 0 ? 0.0 : std::pow(3000.0, -part(random));
    sensor.noise =
        run % 3 == 0
            ? 0.0
            : std::min(0.2, (sensor.resolution + 1e-4) * std::pow(30.0, 2.0 * part(random) - 1.0));
    sensor.offset = 10.0 * part(random);
    sensor.samples = static_cast<std::size_t>(40.0 * std::pow(100.0, part(random)));
    sensor.rate_hz = 1000.0;
    // At least two periods, at most 0.4 of the rate; every fifth in step with it.
    const double low = 2.0 * sensor.rate_hz / static_cast<double>(sensor.samples);
    sensor.frequency_hz = low * std::pow(0.4 * sensor.rate_hz / low, part(random));
    if (run % 5 == 0) {
      sensor.frequency_hz = sensor.rate_hz / std::round(sensor.rate_hz / sensor.frequency_hz);
    }
    const Series series = series_of(sensor, static_cast<unsigned>(run) + 1);
    SignalExpectation expected{.range_low = sensor.offset - 2.5,
                               .range_high = sensor.offset + 2.5,
                               .resolution = sensor.resolution};
    const auto integrity = measure_integrity(Frequency::from_hz(sensor.frequency_hz),
                                             series.stamps_ns, series.values, expected);
    if (!integrity) {
      continue; // too short to be fitted
    }
    ++judged;
    IntegrityThresholds thresholds;
    thresholds.thd = std::max(thresholds.thd, sensor.resolution); // steps are distortion
    const IntegrityFindings findings = judge_integrity(*integrity, thresholds);
    alarms += findings.any();
    if (findings.any()) {
      which << "\nq " << sensor.resolution << ", noise " << sensor.noise << ", n " << sensor.samples
            << ", f " << sensor.frequency_hz << ": range " << findings.over_range << ", stuck "
            << findings.stuck << ", distorted " << findings.distorted;
    }
  }
  EXPECT_GT(judged, 0.9 * runs());
  EXPECT_LE(alarms, 1 + judged / 1000) << which.str();
}

// Whoever stated it was wrong: the signal is not at an end of it.
TEST(SignalIntegrity, ValuesWellBeyondAStatedRangeDisproveIt) {
  for (const double stated : {1.0, 5.0, 9.0}) {
    const Sensor sensor{};
    const auto integrity =
        integrity_of(sensor, series_of(sensor, 3), {.range_low = -stated, .range_high = stated});
    EXPECT_TRUE(integrity.beyond_range) << stated;
    EXPECT_EQ(integrity.at_range_part, 0.0);
    EXPECT_FALSE(judge_integrity(integrity).any()) << stated;
  }
  // A bump is not enough, nor is noise behind the end stop.
  const Sensor sensor{.limit = 9.5};
  Series series = series_of(sensor, 4);
  for (std::size_t i = 700; i < 710; ++i) {
    series.values[i] = 30.0;
  }
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    series.values[i] += 0.02 * std::sin(static_cast<double>(i * i));
  }
  const auto integrity = integrity_of(sensor, series, {.range_low = -9.5, .range_high = 9.5});
  EXPECT_FALSE(integrity.beyond_range);
  EXPECT_TRUE(judge_integrity(integrity).over_range);
}

TEST(SignalIntegrity, EndStopsAreFoundWithAndWithoutAStatedRange) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const Sensor sensor{.limit = 9.5}; // 0.95 of the amplitude
    const Series series = series_of(sensor, seed);
    const SignalIntegrity stated =
        integrity_of(sensor, series, {.range_low = -9.5, .range_high = 9.5});
    const SignalIntegrity found = integrity_of(sensor, series);
    EXPECT_NEAR(stated.at_range_part, 0.20, 0.03);
    EXPECT_NEAR(found.clipped_part, 0.20, 0.03) << seed;
    EXPECT_NEAR(found.clipping_rel, 0.013, 0.008); // the truth is 1.3 %
    EXPECT_TRUE(judge_integrity(stated).over_range);
    EXPECT_TRUE(judge_integrity(stated).refused);
    EXPECT_TRUE(judge_integrity(found).over_range) << seed;
    EXPECT_TRUE(judge_integrity(found).refused) << seed;
    EXPECT_FALSE(judge_integrity(found).stuck);
  }
}

// Gravity on the axis: one end only.
TEST(SignalIntegrity, OneEndStopIsEnough) {
  int found = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const Sensor sensor{.amplitude = 30.0, .offset = 9.81, .limit = 38.5};
    found += judge_integrity(integrity_of(sensor, series_of(sensor, seed))).over_range;
  }
  EXPECT_GE(found, 99);
}

// A rate that is q / p of the frequency, of some converter in single precision.
Sensor at_the_same_phases(std::mt19937_64& random, double noise) {
  std::uniform_real_distribution<double> part(0.0, 1.0);
  const double phases = std::floor(3.0 + 57.0 * part(random));
  const double turns = std::max(1.0, std::floor(0.45 * phases * part(random)));
  Sensor sensor{.amplitude = 1.62, .offset = part(random), .rate_hz = 1000.0};
  sensor.resolution = 1.62 * std::pow(10.0, -1.3 - 2.2 * part(random));
  sensor.noise = noise * sensor.resolution;
  sensor.frequency_hz = sensor.rate_hz * turns / phases;
  sensor.samples =
      static_cast<std::size_t>(std::max(300.0, 8.0 * phases) * (1.0 + 9.0 * part(random)));
  return sensor;
}

Series in_single_precision(Series series) {
  for (double& value : series.values) {
    value = static_cast<double>(static_cast<float>(value));
  }
  return series;
}

TEST(SignalIntegrity, TheSamePhasesOfEveryPeriodAreNoEndStop) {
  std::mt19937_64 random(2);
  std::ostringstream which;
  int alarms = 0;
  for (int run = 0; run < runs(); ++run) {
    const double noise = run % 3 == 0 ? 0.0 : 0.1 * std::pow(30.0, (run % 100) / 99.0); // steps
    const Sensor sensor = at_the_same_phases(random, noise);
    const Series series = in_single_precision(series_of(sensor, static_cast<unsigned>(run) + 1));
    for (const double step : {sensor.resolution, found_resolution(series.values)}) {
      const bool alarm =
          judge_integrity(
              integrity_of({.frequency_hz = sensor.frequency_hz, .resolution = step}, series))
              .over_range;
      alarms += alarm;
      if (alarm) {
        which << "\nq " << sensor.resolution << " taken as " << step << ", noise " << noise
              << ", n " << sensor.samples << ", f " << sensor.frequency_hz;
      }
    }
  }
  EXPECT_LE(alarms, runs() / 500) << which.str();
}

// As long as noise makes the sensor meet other values there.
TEST(SignalIntegrity, EndStopsAtTheSamePhasesAreFoundByTheirNoise) {
  Sensor sensor{.frequency_hz = 1000.0 / 17.0,
                .amplitude = 1.62,
                .resolution = 8.1169738e-4,
                .rate_hz = 1000.0,
                .samples = 1505};
  sensor.limit = 1900.0 * sensor.resolution;
  for (const double noise : {1.0, 3.0}) {
    sensor.noise = noise * sensor.resolution;
    for (unsigned seed = 1; seed <= 100; ++seed) {
      const Series series = in_single_precision(series_of(sensor, seed));
      const Sensor found{.frequency_hz = sensor.frequency_hz,
                         .resolution = found_resolution(series.values)};
      EXPECT_TRUE(judge_integrity(integrity_of(sensor, series)).over_range) << seed;
      EXPECT_TRUE(judge_integrity(integrity_of(found, series)).over_range) << seed;
    }
  }
}

TEST(SignalIntegrity, StuckValuesAreFound) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const Sensor sensor{};
    Series series = series_of(sensor, seed);
    const std::size_t first = 500 + 17 * seed;
    std::fill_n(series.values.begin() + static_cast<std::ptrdiff_t>(first), 50,
                series.values[first]);
    const SignalIntegrity integrity = integrity_of(sensor, series);
    EXPECT_NEAR(static_cast<double>(integrity.longest_stuck), 50.0, 1.0) << seed;
    const IntegrityFindings findings = judge_integrity(integrity);
    EXPECT_TRUE(findings.stuck && findings.refused) << seed;
    EXPECT_FALSE(findings.over_range);
  }
}

// The highest code of two's complement is one step below the range that a description states. A
// drift brings only a few of the last periods there.
TEST(SignalIntegrity, HighestCodeIsTheUpperEndOfTheRange) {
  Sensor sensor;
  Series series = series_of(sensor, 3);
  const double range = 20.0 * sensor.resolution * std::round(1.0 / sensor.resolution);
  std::size_t at_the_end = 0;
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    const double drift = 11.0 * static_cast<double>(i) / static_cast<double>(sensor.samples);
    const double value =
        sensor.resolution * std::round((series.values[i] + drift) / sensor.resolution);
    series.values[i] = std::min(value, range - sensor.resolution);
    at_the_end += series.values[i] < value ? 1 : 0;
  }
  ASSERT_GT(at_the_end, 10U);
  const auto integrity = integrity_of(sensor, series, {.range_low = -range, .range_high = range});
  EXPECT_GE(integrity.at_range_part * static_cast<double>(sensor.samples),
            static_cast<double>(at_the_end));
  EXPECT_TRUE(judge_integrity(integrity).over_range);
}

TEST(SignalIntegrity, ShortRunsThatComeAgainAreFound) {
  for (const std::size_t length : {2U, 3U}) {
    const Sensor sensor;
    Series series = series_of(sensor, 4);
    for (std::size_t begin = 37; begin + length < series.values.size(); begin += 101) {
      for (std::size_t i = begin + 1; i < begin + length; ++i) {
        series.values[i] = series.values[begin];
      }
    }
    const auto integrity = integrity_of(sensor, series);
    EXPECT_EQ(integrity.longest_repeat, length);
    EXPECT_EQ(integrity.longest_stuck, 0U);
    EXPECT_TRUE(judge_integrity(integrity).stuck);
    EXPECT_FALSE(judge_integrity(integrity).refused);
  }
}

// Wherever a run lies in the blocks that the record is looked at in.
TEST(SignalIntegrity, RunsAreFoundAcrossBlocks) {
  const Sensor sensor{.resolution = 0.0, .samples = 3 * value_block_samples + 5};
  for (const std::size_t length : {1UL, 2UL, 3UL, 7UL, 60UL}) {
    for (const std::size_t first :
         {0UL, value_block_samples - 1, value_block_samples, 2 * value_block_samples - 3}) {
      Series series = series_of(sensor, 6);
      std::fill_n(series.values.begin() + static_cast<std::ptrdiff_t>(first), length,
                  series.values[first]);
      EXPECT_EQ(integrity_of(sensor, series).longest_run, length) << first;
      EXPECT_EQ(integrity_of(sensor, series).longest_stuck, length > 4 ? length : 0) << first;
    }
  }
}

TEST(SignalIntegrity, DistortionIsMeasuredWhereverSamplingFoldsIt) {
  for (const double frequency_hz : {20.0, 80.3, 230.7, 310.1}) {
    const Sensor sensor{.frequency_hz = frequency_hz, .second_harmonic = 0.8};
    const SignalIntegrity integrity = integrity_of(sensor, series_of(sensor, 3));
    EXPECT_NEAR(integrity.thd, 0.08, 0.001) << frequency_hz;
    EXPECT_TRUE(judge_integrity(integrity).distorted);
    EXPECT_NEAR(integrity.residual_sd, sensor.noise, 0.002);
  }
  // At a third of the rate it lies on the signal: not to be measured, and not invented.
  const Sensor folded{.frequency_hz = 1003.0 / 3.0, .second_harmonic = 0.8};
  EXPECT_LT(integrity_of(folded, series_of(folded, 3)).thd, 0.01);
}

TEST(SignalIntegrity, TheResidualOfWhiteNoiseIsTheNoiseOfItsNeighbours) {
  const Sensor sensor{.noise = 0.5};
  const SignalIntegrity integrity = integrity_of(sensor, series_of(sensor, 4));
  EXPECT_NEAR(integrity.noise_sd, 0.5, 0.05);
  EXPECT_NEAR(integrity.residual_sd, integrity.noise_sd, 0.05);
}

TEST(SignalIntegrity, AWaveBesideTheSineIsResidualAndNotNoise) {
  const Sensor sensor{.noise = 0.02};
  Series series = series_of(sensor, 4);
  for (std::size_t i = 0; i < series.values.size(); ++i) {
    series.values[i] += 0.5 * std::sin(0.05 * static_cast<double>(i));
  }
  const SignalIntegrity integrity = integrity_of(sensor, series);
  EXPECT_NEAR(integrity.residual_sd, 0.5 / std::sqrt(2.0), 0.03);
  EXPECT_LT(integrity.noise_sd, 0.03);
}

TEST(SignalIntegrity, NothingToFitIsAnError) {
  EXPECT_FALSE(measure_integrity(Frequency::from_hz(80.0), {}, {}, {}));
  const std::vector<double> constant(200, 3.0);
  std::vector<std::int64_t> stamps(constant.size());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    stamps[i] = 1'000'000LL * static_cast<std::int64_t>(i);
  }
  EXPECT_EQ(measure_integrity(Frequency::from_hz(80.0), stamps, constant, {}).error().code,
            ErrorCode::no_excitation);
}

} // namespace
} // namespace dyncal::analysis
