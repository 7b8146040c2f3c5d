#include "analysis/sine/extended_sine_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/analysis/sine/sine_signal.hpp"

namespace dyncal::analysis {
namespace {

Expected<ExtendedFit> fit_one(const ExtendedBasis& basis, Weighting weighting,
                              const std::vector<std::int64_t>& stamps,
                              const std::vector<double>& values, const char* frequency_hz = "80") {
  const std::span<const double> channels[] = {values};
  DYNCAL_TRY(auto fits, fit_sine_extended(*Frequency::parse(frequency_hz), basis, weighting,
                                          epoch_ns, stamps, channels));
  return fits.front();
}

void add(std::vector<double>& values, const Signal& signal,
         const std::vector<std::int64_t>& stamps) {
  const auto more = values_of(signal, stamps);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] += more[i];
  }
}

TEST(SineFitExtended, EqualsThePlainFitWithoutFurtherTerms) {
  const auto stamps = uneven_stamps(3000);
  const auto values = noisy(values_of(Signal{}, stamps), 0.1, 1);
  const std::span<const double> channels[] = {values};
  const SineFit plain = fit_sine(*Frequency::parse("80"), epoch_ns, stamps, channels)->front();
  const auto fit = fit_one({}, Weighting::none, stamps, values);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->fundamental.sine, plain.sine, 1e-14);
  EXPECT_NEAR(fit->fundamental.cosine, plain.cosine, 1e-14);
  EXPECT_NEAR(fit->fundamental.offset, plain.offset, 1e-14);
  EXPECT_NEAR(fit->fundamental.rss / plain.rss, 1.0, 1e-12);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(fit->fundamental.covariance[i], plain.covariance[i], 1e-12 * plain.covariance[0]);
  }
}

TEST(SineFitExtended, SeparatesHarmonicsHumAndDrift) {
  const auto stamps = uneven_stamps(2000);
  auto values = values_of(Signal{}, stamps);
  add(values, {"160", 0.02, 1.1, 0.0, epoch_ns}, stamps);
  add(values, {"240", 0.01, -0.4, 0.0, epoch_ns}, stamps);
  add(values, {"83.3", 0.3, 2.0, 0.0, epoch_ns}, stamps);
  const std::int64_t middle = stamps.front() + (stamps.back() - stamps.front()) / 2;
  const double half = 0.5 * static_cast<double>(stamps.back() - stamps.front());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double u = static_cast<double>(stamps[i] - middle) / half;
    values[i] += 0.5 * u - 0.25 * u * u;
  }
  ExtendedBasis basis;
  basis.drift_order = 2;
  basis.max_harmonic = 3;
  basis.lines = {*Frequency::parse("83.3")};
  const auto fit = fit_one(basis, Weighting::none, stamps, values);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->fundamental.amplitude(), 1.25, 1e-13);
  EXPECT_NEAR(fit->fundamental.phase_rad(), 0.7, 1e-13);
  ASSERT_EQ(fit->harmonics.size(), 2U);
  EXPECT_EQ(fit->harmonics[0].frequency_hz, 160.0);
  EXPECT_NEAR(std::hypot(fit->harmonics[0].sine, fit->harmonics[0].cosine), 0.02, 1e-13);
  EXPECT_NEAR(std::atan2(fit->harmonics[1].cosine, fit->harmonics[1].sine), -0.4, 1e-11);
  ASSERT_EQ(fit->lines.size(), 1U);
  EXPECT_NEAR(std::atan2(fit->lines[0].cosine, fit->lines[0].sine), 2.0, 1e-12);
  ASSERT_EQ(fit->drift.size(), 2U);
  EXPECT_NEAR(fit->drift[0], 0.5, 1e-13);
  EXPECT_NEAR(fit->drift[1], -0.25, 1e-13);
}

TEST(SineFitExtended, FollowsADriftingAmplitude) {
  const auto stamps = uneven_stamps(4000);
  auto values = values_of({"80", 1.0, 0.7, 0.0, epoch_ns}, stamps);
  const std::int64_t middle = stamps.front() + (stamps.back() - stamps.front()) / 2;
  const double half = 0.5 * static_cast<double>(stamps.back() - stamps.front());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] *= 1.0 + 0.01 * static_cast<double>(stamps[i] - middle) / half;
  }
  ExtendedBasis basis;
  basis.drifting_phasor = true;
  const auto fit = fit_one(basis, Weighting::none, stamps, values);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->fundamental.amplitude(), 1.0, 1e-13);
  EXPECT_NEAR(fit->phasor_drift.sine, 0.01 * std::cos(0.7), 1e-13);
  EXPECT_NEAR(fit->phasor_drift.cosine, 0.01 * std::sin(0.7), 1e-13);
}

TEST(SineFitExtended, KeepsItsPrecisionAgainstOutliers) {
  const auto stamps = uneven_stamps(2000);
  const auto clean = values_of(Signal{}, stamps);
  for (const Weighting weighting : {Weighting::huber, Weighting::tukey}) {
    double square = 0.0;
    double stated = 0.0;
    constexpr int trials = 60;
    for (int trial = 0; trial < trials; ++trial) {
      auto values = noisy(clean, 0.01, static_cast<unsigned>(trial));
      std::mt19937_64 random(static_cast<unsigned>(1000 + trial));
      for (int k = 0; k < 20; ++k) {
        values[random() % values.size()] += 0.5 * (random() % 2 ? 1.0 : -1.0); // 1 % of fifty sd
      }
      const auto fit = fit_one({}, weighting, stamps, values);
      ASSERT_TRUE(fit) << fit.error().message;
      EXPECT_GE(fit->outliers, 15U);
      square += std::pow(fit->fundamental.amplitude() - 1.25, 2);
      stated += std::pow(fit->fundamental.u_amplitude(), 2);
    }
    const double bound = 0.01 * std::sqrt(2.0 / 2000.0);
    EXPECT_LT(std::sqrt(square / trials), 1.35 * bound); // within the scatter of 60 trials
    EXPECT_NEAR(std::sqrt(stated / trials) / bound, 1.05, 0.12);
  }
}

TEST(SineFitExtended, RobustFitOfCleanDataChangesLittle) {
  const auto stamps = uneven_stamps(3000);
  const auto values = noisy(values_of(Signal{}, stamps), 0.02, 9);
  const auto plain = fit_one({}, Weighting::none, stamps, values);
  for (const Weighting weighting : {Weighting::huber, Weighting::tukey}) {
    const auto fit = fit_one({}, weighting, stamps, values);
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_LT(std::abs(fit->fundamental.amplitude() - plain->fundamental.amplitude()),
              plain->fundamental.u_amplitude());
    EXPECT_NEAR(fit->fundamental.u_amplitude() / plain->fundamental.u_amplitude(), 1.0, 0.1);
  }
  const auto pure = fit_one({}, Weighting::tukey, stamps, values_of(Signal{}, stamps));
  ASSERT_TRUE(pure) << pure.error().message;
  EXPECT_NEAR(pure->fundamental.amplitude(), 1.25, 1e-14);
}

TEST(SineFitExtended, NamesWhatIsWrongWithTheInput) {
  const auto stamps = uneven_stamps(1000);
  const auto good = noisy(values_of(Signal{}, stamps), 0.1, 2);
  const auto code = [](const Expected<ExtendedFit>& fit) {
    EXPECT_FALSE(fit.has_value());
    return fit ? ErrorCode{} : fit.error().code;
  };
  ExtendedBasis basis;
  basis.lines = {*Frequency::parse("80")};
  EXPECT_EQ(code(fit_one(basis, Weighting::none, stamps, good)), ErrorCode::ill_conditioned);
  basis = {};
  basis.max_harmonic = 7; // 560 Hz at 1 kHz
  EXPECT_EQ(code(fit_one(basis, Weighting::none, stamps, good)), ErrorCode::frequency_out_of_range);
  basis.max_harmonic = 0;
  EXPECT_EQ(code(fit_one(basis, Weighting::none, stamps, good)), ErrorCode::invalid_argument);
  basis = {};
  basis.drift_order = 9;
  EXPECT_EQ(code(fit_one(basis, Weighting::none, stamps, good)), ErrorCode::invalid_argument);
  basis = {};
  basis.drift_order = 3;
  const auto six = uneven_stamps(6);
  EXPECT_EQ(code(fit_one(basis, Weighting::none, six, values_of(Signal{}, six))),
            ErrorCode::too_few_samples);
  EXPECT_EQ(code(fit_one(basis, Weighting::none, stamps, good, "0.02")),
            ErrorCode::ill_conditioned);
  auto bad = good;
  bad[3] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(code(fit_one({}, Weighting::huber, stamps, bad)), ErrorCode::not_finite);
  auto backward = stamps;
  backward[10] = backward[9];
  EXPECT_EQ(code(fit_one({}, Weighting::none, backward, good)), ErrorCode::stamps_not_increasing);
  EXPECT_EQ(code(fit_one({}, Weighting::none, stamps, std::vector<double>(1000, 3.0))),
            ErrorCode::no_excitation);
}

TEST(SineFitExtended, TellsHowFarItIs) {
  const auto stamps = uneven_stamps(200'000);
  const auto first = noisy(values_of(Signal{}, stamps), 0.1, 1);
  const auto second = noisy(values_of(Signal{}, stamps), 0.2, 2);
  const std::span<const double> channels[] = {first, second};
  for (const Weighting weighting : {Weighting::none, Weighting::huber}) {
    const ExtendedBasis basis{.drift_order = 2, .max_harmonic = 5, .lines = {}};
    std::vector<double> shares;
    const auto told = fit_sine_extended(*Frequency::parse("80"), basis, weighting, epoch_ns, stamps,
                                        channels, [&](double share) { shares.push_back(share); });
    ASSERT_TRUE(told) << told.error().message;
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    EXPECT_EQ(shares.front(), 0.0);
    EXPECT_EQ(shares.back(), 1.0);
    EXPECT_GT(shares.size(), 20U);
    EXPECT_NE(std::find(shares.begin(), shares.end(), 0.5), shares.end()); // of two channels one
    const auto silent =
        fit_sine_extended(*Frequency::parse("80"), basis, weighting, epoch_ns, stamps, channels);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ((*told)[i].fundamental.sine, (*silent)[i].fundamental.sine);
      EXPECT_EQ((*told)[i].fundamental.covariance, (*silent)[i].fundamental.covariance);
    }
  }
}

} // namespace
} // namespace dyncal::analysis
