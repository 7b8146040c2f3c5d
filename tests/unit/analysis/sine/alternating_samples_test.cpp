#include "analysis/sine/alternating_samples.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/sine/sine_residuals.hpp"

namespace dyncal::analysis {
namespace {

struct Recording {
  double frequency_hz = 80.3;
  double rate_hz = 1003.05;
  double noise = 0.01; // of the amplitude
  double gain = 1.0;   // of every second sample
  double hum_hz = 0.0; // of a hundredth of the amplitude
  std::size_t lost_every = 0;
  std::size_t samples = 2000;
};

AlternatingPart part_of(const Recording& recording, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, recording.noise);
  const double w = 2.0 * std::numbers::pi * recording.frequency_hz;
  const double phase = std::uniform_real_distribution<double>(-3.0, 3.0)(random);
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  for (std::size_t i = 0; i < recording.samples; ++i) {
    if (recording.lost_every > 0 && i % recording.lost_every == recording.lost_every / 2) {
      continue;
    }
    const double t = static_cast<double>(i) / recording.rate_hz;
    const double hum = 0.01 * std::sin(2.0 * std::numbers::pi * recording.hum_hz * t);
    const double gain = i % 2 == 0 ? 1.0 : recording.gain;
    values.push_back(gain * std::sin(w * t + phase) + noise(random) + hum);
    stamps_ns.push_back(std::llround(t * 1e9));
  }
  const Frequency frequency = Frequency::from_hz(recording.frequency_hz);
  const std::int64_t middle_ns = middle_of_record_ns(stamps_ns);
  const std::span<const double> channel[] = {values};
  const auto fit = fit_sine(frequency, middle_ns, stamps_ns, channel);
  EXPECT_TRUE(fit.has_value());
  return fit ? alternating_part(frequency, fit->front(), middle_ns, stamps_ns, values)
             : AlternatingPart{};
}

double found(const Recording& recording, unsigned seed) {
  return part_of(recording, seed).certain_rel;
}

// Of either sign, by which of the two was first.
TEST(AlternatingSamples, TheDifferenceOfTheGainsHasANormalErrorOfItsUncertainty) {
  for (const double gain : {1.0, 1.0005}) {
    double squares = 0.0, n = 0.0;
    for (unsigned seed = 1; seed <= 200; ++seed) {
      const AlternatingPart part = part_of({.gain = gain}, seed);
      ASSERT_GT(part.u_gain_rel, 0.0);
      EXPECT_LT(part.u_gain_rel, 2.0 * 0.01 * std::sqrt(2.0 / 2000.0));
      const double expected = 0.5 * (gain - 1.0);
      const double error = expected > 0.0 ? std::min(std::abs(part.gain_rel - expected),
                                                     std::abs(part.gain_rel + expected))
                                          : part.gain_rel;
      squares += std::pow(error / part.u_gain_rel, 2);
      n += 1.0;
    }
    EXPECT_LT(squares / n, 1.2) << gain;
    EXPECT_GT(squares / n, gain > 1.0 ? 0.2 : 0.6) << gain;
  }
}

// Gains 1 and g: d is half of their difference, over their mean.
TEST(AlternatingSamples, TwoSensorsInTurnAreFound) {
  for (const double gain : {0.1, 0.95, 1.01}) {
    const double expected = std::abs(1.0 - gain) / (1.0 + gain);
    for (unsigned seed = 1; seed <= 5; ++seed) {
      EXPECT_NEAR(found({.gain = gain}, seed), expected, 0.002) << gain;
      EXPECT_NEAR(found({.gain = gain, .samples = 20000}, seed), expected, 0.001) << gain;
      EXPECT_NEAR(found({.gain = gain, .lost_every = 400}, seed), expected, 0.003) << gain;
    }
  }
}

TEST(AlternatingSamples, NothingIsFoundInSoundRecords) {
  for (unsigned seed = 1; seed <= 180; ++seed) {
    Recording recording;
    recording.frequency_hz = 15.0 + 1.13 * seed;
    EXPECT_EQ(found(recording, seed), 0.0) << recording.frequency_hz << " Hz";
  }
}

// At 100 Hz and 1000 samples a second the line is at 400 Hz, as order 8 of 50 Hz; beside it, hum
// leaks there.
TEST(AlternatingSamples, HumIsNotAnotherSensor) {
  for (const double hum_hz : {400.0, 400.2, 401.1, 403.3}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      EXPECT_EQ(found({.frequency_hz = 100.0, .rate_hz = 1000.0, .hum_hz = hum_hz}, seed), 0.0)
          << hum_hz << " Hz";
    }
  }
}

} // namespace
} // namespace dyncal::analysis
