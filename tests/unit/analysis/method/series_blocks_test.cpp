#include "analysis/method/series_blocks.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double rate_hz = 1000.0;
constexpr double frequency_hz = 80.0;
constexpr double w = 2.0 * std::numbers::pi * frequency_hz;
constexpr std::size_t samples = 500;
constexpr std::size_t shots = 8;
constexpr double noise_rel = 0.01;

// Series whose sample n of shot j is taken at instant(j, n), as the sensor's clock does not know.
template <class Instant>
std::optional<SeriesAgreement> compare(unsigned seed, Instant instant) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, noise_rel);
  std::uniform_real_distribution<double> anywhere(0.0, 6.0);
  std::vector<std::vector<double>> values;
  std::vector<std::int64_t> stamps_ns;
  for (std::size_t n = 0; n < samples; ++n) {
    stamps_ns.push_back(static_cast<std::int64_t>(n) * 1'000'000);
  }
  for (std::size_t j = 0; j < shots; ++j) {
    const double start_rad = anywhere(random);
    std::vector<double>& series = values.emplace_back();
    for (std::size_t n = 0; n < samples; ++n) {
      series.push_back(7.0 * (std::sin(w * instant(j, n) + start_rad) + noise(random)) + 0.3);
    }
  }
  const std::vector<std::span<const double>> channels(values.begin(), values.end());
  const auto fit =
      fit_sine_and_frequency(Frequency::from_hz(frequency_hz), 0.01, 0, stamps_ns, channels);
  EXPECT_TRUE(fit);
  return compare_series(fit->frequency, stamps_ns, channels, fit->channels);
}

double regular(std::size_t n) {
  return static_cast<double>(n) / rate_hz;
}

TEST(SeriesBlocks, GoodSeriesAgree) {
  int found = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    const auto agreement = compare(seed, [](std::size_t, std::size_t n) { return regular(n); });
    ASSERT_TRUE(agreement);
    found += agreement->any() ? 1 : 0;
    EXPECT_TRUE(agreement->turn_rad.empty() == !agreement->rates_differ);
  }
  EXPECT_LE(found, 2); // five tests of 1e-4 each
}

TEST(SeriesBlocks, RatesThatDifferFromShotToShotAreTakenOut) {
  constexpr std::array rates_rel{1e-4, -2e-4, 3e-4, 0.0, -1e-4, 2e-4, -3e-4, 0.5e-4};
  const auto agreement =
      compare(1, [&](std::size_t j, std::size_t n) { return regular(n) * (1.0 + rates_rel[j]); });
  ASSERT_TRUE(agreement);
  EXPECT_TRUE(agreement->rates_differ);
  EXPECT_FALSE(agreement->phases_change);
  ASSERT_EQ(agreement->turn_rad.size(), shots);
  // Fitted at the common rate a shot is right in its middle, and its first sample is w e T / 2
  // late.
  const double half_s = 0.5 * regular(samples - 1);
  for (std::size_t j = 1; j < shots; ++j) {
    EXPECT_NEAR(agreement->turn_rad[j] - agreement->turn_rad[0],
                -w * half_s * (rates_rel[j] - rates_rel[0]), 7.0 * agreement->u_turn_rad);
  }
  EXPECT_GT(agreement->rate_scatter_rel, 1.9e-4);
  EXPECT_LT(agreement->rate_scatter_rel, 9e-4);
}

TEST(SeriesBlocks, AClockThatDriftsAlikeInAllShotsMovesTheFirstSample) {
  constexpr double change_rel = 5e-4;
  const double whole_s = regular(samples - 1);
  const auto agreement = compare(2, [&](std::size_t, std::size_t n) {
    return regular(n) + 0.5 * change_rel * regular(n) * regular(n) / whole_s;
  });
  ASSERT_TRUE(agreement);
  EXPECT_FALSE(agreement->rates_differ);
  EXPECT_TRUE(agreement->phases_change);
  // A parabola about its best line ends a twelfth of it above; a cubic fits the noise beside it.
  EXPECT_NEAR(agreement->u_phase_rad, w * change_rel * whole_s / 12.0, 2e-3);
}

TEST(SeriesBlocks, ASampleLostInOneShotIsFound) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto agreement = compare(seed, [&](std::size_t j, std::size_t n) {
      return regular(j == 3 && n >= 100 + 15 * seed ? n + 1 : n);
    });
    ASSERT_TRUE(agreement);
    EXPECT_TRUE(agreement->phases_change) << seed;
    EXPECT_GT(agreement->largest_change_rad, 0.1);
  }
}

TEST(SeriesBlocks, ShortSeriesAreNotLookedInto) {
  const std::vector<std::int64_t> stamps_ns{0, 1'000'000, 2'000'000};
  const std::vector<double> values{0.0, 1.0, 0.0};
  const std::vector<std::span<const double>> channels{values};
  EXPECT_FALSE(compare_series(Frequency::from_hz(80.0), stamps_ns, channels, {}));
}

} // namespace
} // namespace dyncal::analysis
