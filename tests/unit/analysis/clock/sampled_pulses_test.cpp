#include "analysis/clock/sampled_pulses.hpp"

#include <gtest/gtest.h>

#include "tests/unit/analysis/clock/drawn_pulses.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t five_seconds = 100'000;

std::vector<SampledPulse> pulses_in(const DrawnPulses& drawn, std::size_t at_once = 997,
                                    SampledPulses::Edge edge = SampledPulses::Edge::rising) {
  const std::vector<double> samples = drawn.samples(five_seconds);
  SampledPulses pulses(drawn.samples_per_second, edge);
  std::vector<SampledPulse> all;
  for (std::size_t i = 0; i < samples.size(); i += at_once) {
    const auto part = std::span(samples).subspan(i, std::min(at_once, samples.size() - i));
    for (const SampledPulse& pulse : pulses.push(part)) {
      all.push_back(pulse);
    }
  }
  return all;
}

double place_of(const SampledPulse& pulse) {
  return static_cast<double>(pulse.sample) + pulse.part;
}

TEST(SampledPulses, AreWhereTheyAreBetweenTheSamples) {
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  for (int draw = 0; draw < 40; ++draw) {
    const DrawnPulses drawn{.first = 7000.0 + part(generator), .seed = generator()};
    const auto pulses = pulses_in(drawn);
    ASSERT_EQ(pulses.size(), 5U);
    for (std::size_t i = 0; i < pulses.size(); ++i) {
      EXPECT_NEAR(place_of(pulses[i]), drawn.place_of(i), 2e-3) << drawn.first;
      EXPECT_EQ(pulses[i].u_samples, 0.0);
    }
  }
}

// By their area, whatever the filter: an edge's middle would be early by 0.3 of its time constant.
TEST(SampledPulses, AreAsLateAsTheFilterDelaysSlowSignals) {
  for (const double tau : {1.0, 1.5, 2.0}) {
    const DrawnPulses drawn{.first = 7000.4, .response = one_pole(tau)};
    const auto pulses = pulses_in(drawn);
    ASSERT_EQ(pulses.size(), 5U);
    EXPECT_NEAR(place_of(pulses[2]), drawn.place_of(2) + tau, 0.04) << tau;
  }
}

TEST(SampledPulses, ScatterWithTheNoise) {
  const DrawnPulses drawn{.noise_v = 3.2e-3};
  double squares = 0.0;
  const auto pulses = pulses_in(drawn);
  ASSERT_EQ(pulses.size(), 5U);
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    squares += std::pow(place_of(pulses[i]) - drawn.place_of(i), 2);
  }
  EXPECT_GT(std::sqrt(squares / 5.0), 1e-3);
  EXPECT_LT(std::sqrt(squares / 5.0), 16e-3); // 8 s / (h - l) is 8e-3
}

TEST(SampledPulses, WithoutAFilterAreKnownToASample) {
  const DrawnPulses drawn{.first = 7000.4, .noise_v = 1e-4, .response = no_filter()};
  const auto pulses = pulses_in(drawn);
  ASSERT_EQ(pulses.size(), 5U);
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    EXPECT_NEAR(pulses[i].u_samples, 0.289, 1e-3);
    EXPECT_LT(std::abs(place_of(pulses[i]) - drawn.place_of(i)), 0.51);
  }
}

TEST(SampledPulses, DoNotDependOnHowTheSamplesAreCut) {
  const DrawnPulses drawn{.noise_v = 1e-3};
  const auto whole = pulses_in(drawn, five_seconds);
  for (const std::size_t at_once : {1U, 47U, 4096U}) {
    const auto cut = pulses_in(drawn, at_once);
    ASSERT_EQ(cut.size(), whole.size());
    for (std::size_t i = 0; i < cut.size(); ++i) {
      EXPECT_EQ(cut[i].sample, whole[i].sample);
      EXPECT_EQ(cut[i].part, whole[i].part);
    }
  }
}

TEST(SampledPulses, FallingEdgesAreTheOtherOnes) {
  const DrawnPulses drawn;
  const auto pulses = pulses_in(drawn, 997, SampledPulses::Edge::falling);
  ASSERT_EQ(pulses.size(), 5U);
  EXPECT_NEAR(place_of(pulses[0]), drawn.place_of(0) + 0.1 * drawn.samples_per_second, 2e-3);
}

TEST(SampledPulses, BesideAnAcCoupledInputAreNone) {
  DrawnPulses drawn;
  drawn.response = [filter = linear_phase_filter()](double t) {
    return filter(t) * (t > 0.0 ? std::exp(-t / 200.0) : 1.0);
  };
  SampledPulses pulses(drawn.samples_per_second, SampledPulses::Edge::rising);
  EXPECT_TRUE(pulses.push(drawn.samples(five_seconds)).empty());
  EXPECT_GE(pulses.restless(), 4U);
}

TEST(SampledPulses, NoiseAloneAndARecordWithoutPulsesHaveNone) {
  DrawnPulses drawn{.noise_v = 0.1};
  drawn.high_v = drawn.low_v;
  EXPECT_TRUE(pulses_in(drawn).empty());
}

TEST(SampledPulses, AfterAGapKeepTheirNumbers) {
  const DrawnPulses drawn;
  const std::vector<double> samples = drawn.samples(five_seconds);
  SampledPulses pulses(drawn.samples_per_second, SampledPulses::Edge::rising);
  EXPECT_EQ(pulses.push(std::span(samples).first(30'000)).size(), 2U);
  pulses.restart(45'000);
  const auto later = pulses.push(std::span(samples).subspan(45'000));
  ASSERT_EQ(later.size(), 3U);
  EXPECT_NEAR(place_of(later[0]), drawn.place_of(2), 2e-3);
}

} // namespace
} // namespace dyncal::analysis
