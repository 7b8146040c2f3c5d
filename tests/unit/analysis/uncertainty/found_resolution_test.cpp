#include "analysis/uncertainty/found_resolution.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/sine/sine_fit.hpp"
#include "analysis/uncertainty/quantisation.hpp"

namespace dyncal::analysis {
namespace {

struct Converter {
  double step = 0.01;
  double amplitude = 1.0;
  double noise = 0.0;
  double offset = 0.0;
  double frequency_hz = 81.3;
};

std::vector<double> record(const Converter& converter, std::size_t samples, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise;
  const double phase = std::uniform_real_distribution<double>(0.0, 6.28)(random);
  std::vector<double> values;
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = 1e-3 * static_cast<double>(i);
    const double value = converter.offset +
                         converter.amplitude *
                             std::sin(2.0 * std::numbers::pi * converter.frequency_hz * t + phase) +
                         converter.noise * noise(random);
    values.push_back(converter.step > 0.0 ? converter.step * std::round(value / converter.step)
                                          : value);
  }
  return values;
}

TEST(FoundResolution, FindsTheStepOfAConverter) {
  for (const double steps : {1.5, 3.0, 40.0, 3000.0}) { // of amplitude
    for (const double noise : {0.0, 0.3, 10.0}) {       // in steps
      const double step = 9.80665 / 2048.0;
      const auto values =
          record({.step = step, .amplitude = steps * step, .noise = noise * step, .offset = 9.81},
                 3000, 3);
      EXPECT_NEAR(found_resolution(values) / step, 1.0, 1e-6) << steps << " steps, noise " << noise;
    }
  }
}

TEST(FoundResolution, SinglePrecisionHidesNoStep) {
  auto values = record({.step = 1e-3, .amplitude = 5.0}, 3000, 4);
  for (double& value : values) {
    value = static_cast<double>(static_cast<float>(value));
  }
  EXPECT_NEAR(found_resolution(values), 1e-3, 1e-7);
}

// 17 samples a period: the values lie in a few heaps, hundreds of steps apart.
TEST(FoundResolution, SamplesAtTheSamePhasesHideNoStep) {
  for (const double step : {8.1169738e-4, 1e-3, 2.44e-4}) {
    auto values = record(
        {.step = step, .amplitude = 1.62, .noise = step, .frequency_hz = 1000.0 / 17.0}, 1505, 11);
    for (double& value : values) {
      value = static_cast<double>(static_cast<float>(value));
    }
    EXPECT_NEAR(found_resolution(values) / step, 1.0, 1e-5);
  }
}

TEST(FoundResolution, ContinuousValuesHaveNone) {
  for (unsigned seed = 1; seed <= 1000; ++seed) {
    const auto values = record({.step = 0.0, .noise = seed % 2 == 0 ? 0.01 : 0.0}, 20 + seed, seed);
    ASSERT_EQ(found_resolution(values), 0.0) << seed;
  }
}

TEST(FoundResolution, NothingIsFoundInNothing) {
  EXPECT_EQ(found_resolution({}), 0.0);
  EXPECT_EQ(found_resolution(std::vector<double>(100, 1.0)), 0.0);
  EXPECT_EQ(found_resolution(std::vector<double>(100, std::nan(""))), 0.0);
  EXPECT_EQ(found_resolution(std::vector<double>{1.0, 2.0, 3.0}), 0.0);
}

// A few steps of signal without noise: the error is not random, and the bound of quantisation.hpp
// holds it when the step is known.
TEST(FoundResolution, AFewStepsWithoutNoiseAreCovered) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> anywhere(0.0, 1.0);
  int covered = 0;
  int hidden = 0;
  constexpr int runs = 500;
  for (int run = 0; run < runs; ++run) {
    const Converter converter{.step = 1.0,
                              .amplitude = 1.5 + 4.0 * anywhere(random),
                              .offset = anywhere(random),
                              .frequency_hz = 70.0 + 20.0 * anywhere(random)};
    const auto values = record(converter, 2000, static_cast<unsigned>(run));
    std::vector<std::int64_t> stamps;
    for (std::size_t i = 0; i < values.size(); ++i) {
      stamps.push_back(1'000'000 * static_cast<std::int64_t>(i));
    }
    const std::span<const double> channels[] = {values};
    const auto fit = fit_sine(Frequency::from_hz(converter.frequency_hz), 0, stamps, channels);
    ASSERT_TRUE(fit);
    const SineFit& sine = fit->front();
    const double step = found_resolution(values);
    ASSERT_NEAR(step, 1.0, 1e-9);
    const auto steps = quantisation_uncertainty(sine.amplitude(), sine.residual_sd(), step,
                                                Frequency::from_hz(converter.frequency_hz), stamps);
    const double error = std::abs(sine.amplitude() - converter.amplitude);
    covered += error <= 2.0 * std::hypot(sine.u_amplitude(), steps.u_amplitude);
    hidden += error > 5.0 * sine.u_amplitude();
  }
  EXPECT_GE(covered, 0.94 * runs);
  EXPECT_GT(hidden, 0.2 * runs); // what it is needed for
}

} // namespace
} // namespace dyncal::analysis
