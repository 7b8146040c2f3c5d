#include "analysis/sine/disturbances.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
};

// Sine and cosine coefficients 3 and 4 at 46.7 Hz about t = 0.
Record record(double second_harmonic, double hum, double noise, double duration_s = 3.0) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Record result;
  for (int i = 0; i < static_cast<int>(duration_s * 5000.0); ++i) {
    const double t = i * 2e-4;
    const double turn = 2.0 * std::numbers::pi * t;
    result.stamps_ns.push_back(200'000ll * i);
    result.values.push_back(3.0 * std::sin(46.7 * turn) + 4.0 * std::cos(46.7 * turn) +
                            second_harmonic * std::cos(93.4 * turn) +
                            hum * std::sin(50.0 * turn + 1.0) + noise * normal(random) + 0.5);
  }
  return result;
}

const Frequency frequency = *Frequency::parse("46.7");

TEST(Disturbances, ACleanRecordKeepsThePlainResult) {
  const Record clean = record(0.0, 0.0, 1e-3);
  const std::array channels{std::span<const double>(clean.values)};
  const auto result = fit_sine_beside_disturbances(frequency, 0, clean.stamps_ns, channels);
  const auto plain = fit_sine(frequency, 0, clean.stamps_ns, channels);
  ASSERT_TRUE(result && plain);
  EXPECT_EQ((*result)[0].fit.sine, (*plain)[0].sine);
  EXPECT_EQ((*result)[0].fit.rss, (*plain)[0].rss);
  EXPECT_TRUE((*result)[0].removed_hz.empty());
  EXPECT_TRUE((*result)[0].values.empty());
}

TEST(Disturbances, HarmonicsAndHumAreFoundAndTakenOut) {
  const Record disturbed = record(0.05, 0.02, 1e-4);
  const std::array channels{std::span<const double>(disturbed.values)};
  const auto result = fit_sine_beside_disturbances(frequency, 0, disturbed.stamps_ns, channels);
  ASSERT_TRUE(result.has_value());
  const CleanedFit& fit = result->front();
  EXPECT_NEAR(fit.fit.sine, 3.0, 6e-6);
  EXPECT_NEAR(fit.fit.cosine, 4.0, 6e-6);
  EXPECT_NEAR(fit.fit.residual_sd(), 1e-4, 3e-6);
  ASSERT_EQ(fit.values.size(), disturbed.values.size());
  const std::array cleaned{std::span<const double>(fit.values)};
  EXPECT_NEAR((*fit_sine(frequency, 0, disturbed.stamps_ns, cleaned))[0].residual_sd(), 1e-4, 3e-6);
}

TEST(Disturbances, ALineTooCloseToTellApartIsLeftAlone) {
  const Record disturbed = record(0.0, 0.02, 1e-4, 0.4); // 3.3 Hz away, 0.4 s
  const std::array channels{std::span<const double>(disturbed.values)};
  const auto result = fit_sine_beside_disturbances(frequency, 0, disturbed.stamps_ns, channels);
  ASSERT_TRUE(result.has_value());
  for (const double line : result->front().removed_hz) {
    EXPECT_NE(line, 50.0);
  }
}

TEST(Disturbances, LooksForTheMainsThatItIsTold) {
  const Record disturbed = record(0.0, 0.02, 1e-4);
  const std::array channels{std::span<const double>(disturbed.values)};
  const auto lines = [&](std::span<const double> mains_hz) {
    return fit_sine_beside_disturbances(frequency, 0, disturbed.stamps_ns, channels, mains_hz)
        ->front()
        .removed_hz;
  };
  EXPECT_EQ(lines(std::array{60.0}), std::vector<double>{});
  EXPECT_EQ(lines(std::array{25.0}), std::vector<double>{50.0}); // its second multiple
  // The third multiple of 16.7 Hz cannot be told from 50 Hz.
  EXPECT_EQ(lines(std::array{16.7, 50.0}), std::vector<double>{50.0});
}

// Frequency and drift resemble each other so much that fitting them in turn needs many rounds, and
// that u is larger than that of a frequency without drift.
TEST(Disturbances, FrequencyOfTwoPeriodsBesideADrift) {
  constexpr double true_hz = 4.2, noise_sd = 1e-3, drift = 0.3;
  constexpr int draws = 40;
  double squares = 0.0;
  for (unsigned seed = 1; seed <= draws; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const double phase = std::uniform_real_distribution<double>(-3.0, 3.0)(random);
    Record drifting;
    for (int i = 0; i < 500; ++i) {
      const double t = 1e-3 * i;
      drifting.stamps_ns.push_back(1'000'000ll * i);
      drifting.values.push_back(std::sin(2.0 * std::numbers::pi * true_hz * t + phase) + drift * t +
                                noise_sd * normal(random));
    }
    const std::array channels{std::span<const double>(drifting.values)};
    const auto fit = fit_frequency_beside_disturbances(Frequency::from_hz(true_hz), 0.01, 0,
                                                       drifting.stamps_ns, channels);
    ASSERT_TRUE(fit.has_value());
    squares += std::pow((fit->frequency.hz() - true_hz) / fit->u_frequency_hz, 2) / draws;
  }
  EXPECT_LT(std::sqrt(squares), 1.5); // 1 expected
  EXPECT_GT(std::sqrt(squares), 0.6);
}

TEST(Disturbances, AShortRecordFailsAsAPlainFitDoes) {
  const Record clean = record(0.0, 0.0, 1e-3, 0.0006);
  const std::array channels{std::span<const double>(clean.values)};
  EXPECT_EQ(fit_sine_beside_disturbances(frequency, 0, clean.stamps_ns, channels).error().code,
            ErrorCode::too_few_samples);
}

} // namespace
} // namespace dyncal::analysis
