#include "analysis/step/held_values.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

struct Held {
  SampledSine sine;
  double part = 0.0; // of the values
  std::size_t samples = 2000;
};

double beyond_chance(const Held& held, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double phase = 6.0 * uniform(random);
  std::vector<double> values;
  double before = 0.0;
  for (std::size_t i = 0; i < held.samples; ++i) {
    double value =
        held.sine.amplitude * std::sin(held.sine.turn_rad * static_cast<double>(i) + phase) +
        held.sine.noise_sd * noise(random);
    if (held.sine.step > 0.0) {
      value = held.sine.step * std::round(value / held.sine.step);
    }
    values.push_back(i > 0 && uniform(random) < held.part ? before : value);
    before = value;
  }
  std::vector<ValueBlock> blocks((values.size() + value_block_samples - 1) / value_block_samples);
  for (ValueBlock& block : blocks) {
    block.repeats = true;
  }
  return repeated_beyond_chance(values, blocks, held.sine);
}

TEST(HeldValues, AreCounted) {
  const SampledSine sine{.amplitude = 1.0, .turn_rad = 0.1, .noise_sd = 0.01, .step = 0.0};
  EXPECT_NEAR(beyond_chance({sine, 0.01}, 1), 0.01, 0.006);
  EXPECT_NEAR(beyond_chance({sine, 0.1}, 1), 0.1, 0.02);
  EXPECT_NEAR(beyond_chance({{1.0, 0.1, 0.01, 0.001}, 0.2}, 1), 0.16, 0.03); // one before is held
}

TEST(HeldValues, StepsAreNoReasonForAlarm) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  for (unsigned run = 0; run < 2000; ++run) {
    Held sound{{.amplitude = 1.0,
                .turn_rad = 0.005 * std::pow(300.0, part(random)),
                .noise_sd = run % 5 == 0 ? 0.0 : 1e-3 * std::pow(300.0, part(random)),
                .step = 1e-4 * std::pow(3000.0, part(random))}};
    EXPECT_EQ(beyond_chance(sound, run), 0.0)
        << "turn " << sound.sine.turn_rad << ", noise " << sound.sine.noise_sd << ", step "
        << sound.sine.step;
  }
}

} // namespace
} // namespace dyncal::analysis
