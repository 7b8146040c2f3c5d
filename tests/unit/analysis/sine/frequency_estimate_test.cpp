#include "analysis/sine/frequency_estimate.hpp"

#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/analysis/sine/sine_signal.hpp"

namespace dyncal::analysis {
namespace {

Expected<Frequency> estimate(const std::vector<std::int64_t>& stamps,
                             const std::vector<double>& values) {
  const std::array<std::span<const double>, 1> columns{values};
  return estimate_frequency(stamps, columns);
}

TEST(FrequencyEstimate, IsGoodToATenthOfABin) {
  const auto stamps = uneven_stamps(2000);
  for (const char* text : {"1.7", "80", "199.87", "431.3"}) {
    const Signal signal{.frequency_hz = text};
    const auto found = estimate(stamps, noisy(values_of(signal, stamps), 0.05, 1));
    ASSERT_TRUE(found.has_value()) << text << ": " << found.error().message;
    EXPECT_NEAR(found->hz(), std::stod(text), 0.1 * 0.5) << text; // a bin is 0.5 Hz
  }
}

TEST(FrequencyEstimate, GapsStayEmpty) {
  auto stamps = uneven_stamps(2000);
  stamps.erase(stamps.begin() + 700, stamps.begin() + 1100);
  const auto found = estimate(stamps, values_of(Signal{}, stamps));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->hz(), 80.0, 0.25); // half a bin: the search of the fit finds it from there
}

// A temperature that settles, in the units of a sine's amplitude.
std::vector<double> drifting(std::vector<double> values, double by) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i) / static_cast<double>(values.size());
    values[i] += by * (1.0 - std::exp(-2.0 * x));
  }
  return values;
}

TEST(FrequencyEstimate, FindsTheSineInARecordThatDrifts) {
  const auto stamps = uneven_stamps(3001);
  for (const double by : {1.0, 10.0, 1000.0}) {
    const auto found = estimate(stamps, drifting(noisy(values_of(Signal{}, stamps), 0.05, 1), by));
    ASSERT_TRUE(found.has_value()) << by << ": " << found.error().message;
    EXPECT_NEAR(found->hz(), 80.0, 0.1) << by;
  }
}

TEST(FrequencyEstimate, ManyDriftingColumnsDoNotHideTheSineOfOne) {
  const auto stamps = uneven_stamps(3001);
  const auto sine = noisy(values_of(Signal{}, stamps), 0.05, 1);
  const auto drift = drifting(noisy(std::vector<double>(stamps.size(), 0.0), 0.01, 2), 1.0);
  const std::array<std::span<const double>, 6> columns{drift, drift, drift, sine, drift, drift};
  const auto found = estimate_frequency(stamps, columns);
  ASSERT_TRUE(found.has_value()) << found.error().message;
  EXPECT_NEAR(found->hz(), 80.0, 0.1);
}

TEST(FrequencyEstimate, TwoCyclesAreASine) {
  const auto stamps = uneven_stamps(2000); // 2 s
  const Signal signal{.frequency_hz = "1.0"};
  const auto found = estimate(stamps, noisy(values_of(signal, stamps), 0.05, 1));
  ASSERT_TRUE(found.has_value()) << found.error().message;
  EXPECT_NEAR(found->hz(), 1.0, 0.25);
}

TEST(FrequencyEstimate, SaysWhyNot) {
  const auto stamps = uneven_stamps(5000);
  const std::vector<double> still(stamps.size(), 0.0);
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    const auto noise = estimate(stamps, noisy(still, 0.05, seed));
    ASSERT_FALSE(noise.has_value()) << noise->hz();
    EXPECT_EQ(noise.error().code, ErrorCode::no_excitation);
    EXPECT_THAT(noise.error().message, testing::HasSubstr("does not stand out of the noise"));
    const auto drift = estimate(stamps, drifting(noisy(still, 0.05, seed), 1.0));
    ASSERT_FALSE(drift.has_value()) << drift->hz();
    EXPECT_THAT(drift.error().message, testing::HasSubstr("the values drift"));
  }
}

// A transform of a large prime size takes minutes where the next size takes milliseconds.
TEST(FrequencyEstimate, IsQuickForEverySize) {
  const auto stamps = uneven_stamps(100003); // prime
  const auto values = noisy(values_of(Signal{}, stamps), 0.05, 1);
  const std::array<std::span<const double>, 4> columns{values, values, values, values};
  const std::clock_t began = std::clock(); // others may use the machine
  const auto found = estimate_frequency(stamps, columns);
  const double took_s = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
  ASSERT_TRUE(found.has_value()) << found.error().message;
  EXPECT_NEAR(found->hz(), 80.0, 0.002);
  EXPECT_LT(took_s, 2.0);
}

TEST(FrequencyEstimate, RefusesWhatHasNoFrequency) {
  const auto stamps = uneven_stamps(100);
  EXPECT_EQ(estimate(stamps, std::vector<double>(100, 2.0)).error().code, ErrorCode::no_excitation);
  EXPECT_EQ(estimate({1, 2, 3}, {0.0, 1.0, 0.0}).error().code, ErrorCode::too_few_samples);
  EXPECT_EQ(estimate(stamps, std::vector<double>(99, 2.0)).error().code,
            ErrorCode::invalid_argument);
  auto values = values_of(Signal{}, stamps);
  values[50] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(estimate(stamps, values).error().code, ErrorCode::not_finite);
  auto backwards = stamps;
  std::swap(backwards[10], backwards[11]);
  EXPECT_EQ(estimate(backwards, values_of(Signal{}, stamps)).error().code,
            ErrorCode::stamps_not_increasing);
}

TEST(FrequencyEstimate, TellsHowManyColumnsAreBehind) {
  const auto stamps = uneven_stamps(2000);
  const auto values = noisy(values_of(Signal{}, stamps), 0.05, 1);
  const std::vector<double> constant(stamps.size(), 1.0);
  const std::array<std::span<const double>, 4> columns{values, constant, values, values};
  std::vector<double> shares;
  const auto told =
      estimate_frequency(stamps, columns, [&](double share) { shares.push_back(share); });
  ASSERT_TRUE(told.has_value());
  EXPECT_THAT(shares, testing::ElementsAre(0.25, 0.5, 0.75, 1.0));
  EXPECT_EQ(told->hz(), estimate_frequency(stamps, columns)->hz());
}

} // namespace
} // namespace dyncal::analysis
