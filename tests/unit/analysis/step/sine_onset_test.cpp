#include "analysis/step/sine_onset.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

struct Excitation {
  double frequency_hz = 80.0;
  double begin_s = 0.3;
  double ramp_s = 0.02;
  double phase_rad = 0.7;

  [[nodiscard]] double at(double t) const {
    const double level = std::clamp((t - begin_s) / ramp_s, 0.0, 1.0);
    return level * std::sin(2.0 * std::numbers::pi * frequency_hz * t + phase_rad);
  }
};

struct Recording {
  double rate_hz = 1003.05;
  double clock_begins_s = 0.0; // in true time
  double noise = 0.01;
  double delay_s = 0.0;
  double offset = 0.05;
};

// From 0.15 s on; evaluated from `first_s` on, in true time.
std::optional<SineOnset> onset_of(const Excitation& excitation, const Recording& recording,
                                  double first_s, unsigned seed, std::size_t knocked = 0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, recording.noise);
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  for (double t = 0.15; t < 2.0; t += 1.0 / recording.rate_hz) {
    stamps_ns.push_back(std::llround(1e9 * (t - recording.clock_begins_s)));
    values.push_back(4.0 *
                     (excitation.at(t - recording.delay_s) + recording.offset + noise(random)));
  }
  if (knocked > 0) {
    values[knocked] += 100.0;
  }
  const auto first_ns = std::llround(1e9 * (first_s - recording.clock_begins_s));
  const auto before = static_cast<std::size_t>(
      std::lower_bound(stamps_ns.begin(), stamps_ns.end(), first_ns) - stamps_ns.begin());
  const Frequency frequency = Frequency::from_hz(excitation.frequency_hz);
  const auto stamps = std::span(stamps_ns);
  const std::span<const double> evaluated[] = {std::span(values).subspan(before)};
  const auto fit = fit_sine(frequency, stamps_ns[before], stamps.subspan(before), evaluated);
  return sine_onset(frequency, stamps_ns[before], fit->front(),
                    {stamps.first(before), std::span(values).first(before)}, stamps_ns[before]);
}

// Two clocks, two rates, two beginnings of what is evaluated: their offset is left.
TEST(SineOnset, TwoRecordsOfOneExcitationDifferByTheirClocksAndTheDelay) {
  for (const double frequency_hz : {12.5, 20.0, 80.0, 203.0, 400.0}) {
    for (const double delay_s : {0.0, 0.0015, 0.02}) {
      for (unsigned seed = 1; seed <= 5; ++seed) {
        const Excitation excitation{.frequency_hz = frequency_hz, .phase_rad = 1.0 * seed};
        const double later_s = 0.0137 * seed;
        const auto sensor =
            onset_of(excitation, {.clock_begins_s = -7.1, .delay_s = delay_s}, 0.6 + later_s, seed);
        const auto reference =
            onset_of(excitation, {.rate_hz = 5000.0, .noise = 0.003}, 0.6, seed + 100);
        ASSERT_TRUE(sensor && reference);
        const double offset_s = sensor->before_s - reference->before_s;
        const double u_s = std::hypot(sensor->u_s, reference->u_s);
        EXPECT_NEAR(offset_s, later_s - delay_s, 3.0 * u_s + 1e-3) << frequency_hz << " Hz";
        EXPECT_LT(u_s, 2e-3 + 0.06 / frequency_hz);
      }
    }
  }
}

TEST(SineOnset, NoiseIsInTheUncertainty) {
  const auto quiet = onset_of({}, {}, 0.6, 1), noisy = onset_of({}, {.noise = 1.0}, 0.6, 1);
  ASSERT_TRUE(quiet && noisy);
  EXPECT_GT(noisy->u_s, 10.0 * quiet->u_s);
  EXPECT_NEAR(noisy->before_s, quiet->before_s, 3.0 * noisy->u_s);
}

TEST(SineOnset, SaysNothingOfAKnockNorWithoutSamples) {
  EXPECT_TRUE(onset_of({}, {}, 0.6, 1).has_value());
  EXPECT_FALSE(onset_of({}, {}, 0.6, 1, 100).has_value());
  EXPECT_FALSE(onset_of({}, {}, 0.15, 1).has_value());
}

} // namespace
} // namespace dyncal::analysis
