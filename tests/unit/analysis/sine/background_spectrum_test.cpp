#include "analysis/sine/background_spectrum.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double duration_s = 1.5;

struct Channel {
  double rate_hz = 5000.0;
  double noise = 1e-3;
  double lost = 0.0; // part of the samples
  unsigned seed = 1;
};

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;

  template <class Signal>
  Record(const Channel& channel, Signal signal) {
    std::mt19937_64 random(channel.seed);
    std::normal_distribution<double> noise(0.0, channel.noise);
    std::uniform_real_distribution<double> part;
    for (int i = 0; i < static_cast<int>(duration_s * channel.rate_hz); ++i) {
      const double t = i / channel.rate_hz;
      const double value = signal(2.0 * std::numbers::pi * t) + noise(random);
      if (part(random) >= channel.lost) {
        stamps_ns.push_back(std::llround(t * 1e9));
        values.push_back(value);
      }
    }
  }
};

std::optional<LineAmplitude> line_in(const Record& record, double line_hz, double excitation_hz) {
  const auto spectrum =
      BackgroundSpectrum::of_residuals(excitation_hz, 400.0, record.stamps_ns, record.values);
  return spectrum ? spectrum->line(line_hz) : std::nullopt;
}

TEST(BackgroundSpectrum, ALineHasItsAmplitudeWhateverTheRate) {
  for (const double rate_hz : {1003.05, 5000.0, 20000.0}) {
    for (const double lost : {0.0, 0.01}) {
      const Record record({.rate_hz = rate_hz, .lost = lost}, [](double turn) {
        return 0.02 * std::sin(50.02 * turn + 1.0) + 0.03 * std::sin(189.0 * turn);
      });
      const auto line = line_in(record, 50.0, 63.0);
      ASSERT_TRUE(line);
      EXPECT_NEAR(line->amplitude, 0.02, 0.001) << rate_hz << ", " << lost;
      EXPECT_LT(line->u_component, 5e-4) << rate_hz << ", " << lost;
    }
  }
}

// u of white noise of s: s sqrt(2 / n) sqrt(1.5), 1.5 for Hann's window.
TEST(BackgroundSpectrum, NoiseIsThatBesideTheLine) {
  double square = 0.0, expected = 0.0;
  constexpr int runs = 200;
  for (unsigned seed = 0; seed < runs; ++seed) {
    const Record record({.seed = seed}, [](double) { return 0.0; });
    const auto line = line_in(record, 50.0, 80.0);
    ASSERT_TRUE(line);
    square += line->amplitude * line->amplitude / runs;
    expected += 2.0 * line->u_component * line->u_component / runs;
  }
  const double theory = 2.0 * 1.5 * 2.0 * 1e-6 / (5000.0 * duration_s);
  EXPECT_NEAR(square / theory, 1.0, 0.3);
  EXPECT_NEAR(expected / theory, 1.0, 0.2);
}

// An exciter's harmonics of 3 % are not taken for hum beside them.
TEST(BackgroundSpectrum, TellsNothingThatMayBeAHarmonic) {
  const Record record({}, [](double turn) { return 0.03 * std::sin(2.0 * 63.0 * turn); });
  EXPECT_FALSE(line_in(record, 125.0, 63.0)); // 126 Hz is 1.5 / T away
  const auto apart = line_in(record, 123.0, 63.0);
  ASSERT_TRUE(apart);
  EXPECT_LT(apart->amplitude, 0.001);
  EXPECT_FALSE(line_in(record, 189.0, 63.0));
  EXPECT_FALSE(line_in(record, 15.0 * 20.0, 20.0)); // of any order
  EXPECT_FALSE(line_in(record, 63.5, 63.0));
  EXPECT_FALSE(line_in(record, 1.0, 63.0)); // drift
}

TEST(BackgroundSpectrum, NeedsSamples) {
  const std::vector<std::int64_t> few{0, 1'000'000, 2'000'000};
  EXPECT_FALSE(BackgroundSpectrum::of_residuals(80.0, 100.0, few, std::vector<double>(3, 0.1)));
  const std::vector<std::int64_t> same(100, 5);
  EXPECT_FALSE(BackgroundSpectrum::of_residuals(80.0, 100.0, same, std::vector<double>(100, 0.1)));
}

} // namespace
} // namespace dyncal::analysis
