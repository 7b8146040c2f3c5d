#include "analysis/sine/sine_fit.hpp"

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

Expected<std::vector<SineFit>> fit_one(const std::string& frequency_hz,
                                       std::int64_t phase_origin_ns,
                                       const std::vector<std::int64_t>& stamps,
                                       const std::vector<double>& values) {
  const std::span<const double> channels[] = {values};
  return fit_sine(*Frequency::parse(frequency_hz), phase_origin_ns, stamps, channels);
}

ErrorCode error_of(const std::vector<std::int64_t>& stamps, const std::vector<double>& values,
                   const std::string& frequency_hz = "80") {
  const auto fit = fit_one(frequency_hz, epoch_ns, stamps, values);
  EXPECT_FALSE(fit.has_value());
  if (fit) {
    return ErrorCode{};
  }
  EXPECT_FALSE(fit.error().message.empty());
  return fit.error().code;
}

TEST(SineFit, FindsPureSineOnUnevenStampsToRounding) {
  const Signal signal;
  const auto stamps = uneven_stamps(2000);
  const auto fit = fit_one("80", epoch_ns, stamps, values_of(signal, stamps));
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->front().amplitude(), signal.amplitude, 1e-14);
  EXPECT_NEAR(fit->front().phase_rad(), signal.phase_rad, 1e-14);
  EXPECT_NEAR(fit->front().offset, signal.offset, 1e-14);
  EXPECT_LT(fit->front().rss, 1e-27);
  EXPECT_EQ(fit->front().samples, 2000U);
  EXPECT_EQ(fit->front().degrees_of_freedom, 1997.0);
}

TEST(SineFit, KeepsPhaseOverSixHoursForDecimalFrequency) {
  Signal signal;
  signal.frequency_hz = "199.87";
  std::vector<std::int64_t> stamps; // a burst at each end
  for (int i = 0; i < 3000; ++i) {
    stamps.push_back(epoch_ns + i * 1'000'003LL);
  }
  for (int i = 0; i < 3000; ++i) {
    stamps.push_back(epoch_ns + 21'600'000'000'000 + i * 999'983LL);
  }
  const auto fit = fit_one("199.87", epoch_ns, stamps, values_of(signal, stamps));
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->front().phase_rad(), signal.phase_rad, 1e-14);
  EXPECT_NEAR(fit->front().amplitude(), signal.amplitude, 1e-14);
}

TEST(SineFit, EvaluatesSparseUnevenRecordsFarAboveTheirMeanRate) {
  Signal signal;
  signal.frequency_hz = "199.87";
  const auto stamps = uneven_stamps(2000, 10'800'000'000);
  const auto fit = fit_one("199.87", epoch_ns, stamps, values_of(signal, stamps));
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->front().phase_rad(), signal.phase_rad, 1e-14);
}

TEST(SineFit, TurnsThePhaseToAnyReferenceInstant) {
  const Signal signal;
  const Frequency f = *Frequency::parse("80");
  const auto stamps = uneven_stamps(500);
  const auto values = values_of(signal, stamps);
  for (const std::int64_t shift : {-epoch_ns, std::int64_t{-1'000'000'007}, std::int64_t{0},
                                   std::int64_t{3'600'000'000'001}}) {
    const auto fit = fit_one("80", epoch_ns + shift, stamps, values);
    ASSERT_TRUE(fit) << fit.error().message;
    const double expected = signal.phase_rad + 2.0 * std::numbers::pi * f.reduced_turns(shift);
    EXPECT_NEAR(std::remainder(fit->front().phase_rad() - expected, 2.0 * std::numbers::pi), 0.0,
                2e-14)
        << shift;
    EXPECT_NEAR(fit->front().u_phase_rad() /
                    fit_one("80", epoch_ns, stamps, values)->front().u_phase_rad(),
                1.0, 1e-9)
        << shift;
  }
}

TEST(SineFit, FitsEveryChannelOnItsOwn) {
  const auto stamps = uneven_stamps(3000);
  std::vector<std::vector<double>> data;
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (int j = 0; j < 6; ++j) {
    Signal signal;
    signal.amplitude = std::pow(10.0, j - 3);
    signal.phase_rad = 0.3 * j;
    signal.offset = 100.0 * j;
    data.push_back(values_of(signal, stamps));
    for (double& y : data.back()) {
      y += noise(random) * signal.amplitude;
    }
  }
  const std::vector<std::span<const double>> channels(data.begin(), data.end());
  const auto together = fit_sine(*Frequency::parse("80"), epoch_ns, stamps, channels);
  ASSERT_TRUE(together) << together.error().message;
  for (std::size_t j = 0; j < data.size(); ++j) {
    const auto alone = fit_one("80", epoch_ns, stamps, data[j]);
    ASSERT_TRUE(alone);
    EXPECT_EQ((*together)[j].sine, alone->front().sine);
    EXPECT_EQ((*together)[j].cosine, alone->front().cosine);
    EXPECT_EQ((*together)[j].offset, alone->front().offset);
    EXPECT_EQ((*together)[j].rss, alone->front().rss);
    EXPECT_NEAR((*together)[j].residual_sd() / (*together)[j].amplitude(), 0.01, 0.001);
  }
}

TEST(SineFit, StatesTheScatterOfItsResults) {
  const Signal signal;
  const auto stamps = uneven_stamps(400);
  const auto clean = values_of(signal, stamps);
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0.0, 0.05);
  constexpr int trials = 2000;
  int amplitude_inside = 0;
  int phase_inside = 0;
  for (int trial = 0; trial < trials; ++trial) {
    auto values = clean;
    for (double& y : values) {
      y += noise(random);
    }
    const SineFit fit = fit_one("80", epoch_ns, stamps, values)->front();
    amplitude_inside +=
        std::abs(fit.amplitude() - signal.amplitude) < 2.0 * fit.u_amplitude() ? 1 : 0;
    phase_inside += std::abs(fit.phase_rad() - signal.phase_rad) < 2.0 * fit.u_phase_rad() ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(amplitude_inside) / trials, 0.9545,
              0.0141); // three standard deviations
  EXPECT_NEAR(static_cast<double>(phase_inside) / trials, 0.9545, 0.0141);
}

TEST(SineFit, KeepsTheNoiseBesideALargeOffset) {
  Signal signal;
  const auto stamps = uneven_stamps(5000);
  auto small = values_of(signal, stamps);
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 1e-3);
  for (double& y : small) {
    y = std::ldexp(std::round(std::ldexp(y + noise(random), 30)), -30); // exact beside the offset
  }
  auto large = small;
  for (double& y : large) {
    y += 1048576.0;
  }
  const SineFit reference = fit_one("80", epoch_ns, stamps, small)->front();
  const SineFit fit = fit_one("80", epoch_ns, stamps, large)->front();
  EXPECT_NEAR(fit.rss / reference.rss, 1.0, 1e-9);
  EXPECT_NEAR(fit.amplitude(), reference.amplitude(), 1e-12);
}

TEST(SineFit, WorksDownToAFiftiethOfACycle) {
  Signal signal;
  signal.frequency_hz = "0.02";
  const auto stamps = uneven_stamps(1000);
  const auto fit = fit_one("0.02", epoch_ns, stamps, values_of(signal, stamps));
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->front().amplitude(), signal.amplitude, 1e-11);
  EXPECT_NEAR(fit->front().phase_rad(), signal.phase_rad, 1e-11);
}

TEST(SineFit, RefusesFewerSamplesThanParameters) {
  for (std::size_t n = 0; n <= 3; ++n) {
    const auto stamps = uneven_stamps(n);
    EXPECT_EQ(error_of(stamps, values_of(Signal{}, stamps)), ErrorCode::too_few_samples) << n;
  }
}

TEST(SineFit, RefusesValuesThatAreNotFinite) {
  const auto stamps = uneven_stamps(1000);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    for (const std::size_t where : {0U, 1U, 517U, 999U}) {
      auto values = values_of(Signal{}, stamps);
      values[where] = bad;
      EXPECT_EQ(error_of(stamps, values), ErrorCode::not_finite) << bad << ' ' << where;
    }
  }
}

TEST(SineFit, NamesTheSampleThatIsNotFinite) {
  const auto stamps = uneven_stamps(1000);
  auto values = values_of(Signal{}, stamps);
  values[517] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(fit_one("80", epoch_ns, stamps, values).error().message.find("sample 517 of channel 0"),
            std::string::npos);
}

TEST(SineFit, RefusesStampsThatDoNotIncrease) {
  const auto good = uneven_stamps(1200);
  const auto values = values_of(Signal{}, good);
  for (const std::size_t where : {1U, 7U, 8U, 9U, 511U, 512U, 513U, 1024U, 1198U}) {
    auto stamps = good;
    stamps[where] = stamps[where - 1];
    EXPECT_EQ(error_of(stamps, values), ErrorCode::stamps_not_increasing) << where;
    stamps[where] = std::numeric_limits<std::int64_t>::min();
    EXPECT_EQ(error_of(stamps, values), ErrorCode::stamps_not_increasing) << where;
  }
  auto reversed = good;
  std::swap(reversed.front(), reversed.back());
  EXPECT_EQ(error_of(reversed, values), ErrorCode::stamps_not_increasing);
}

TEST(SineFit, RefusesFrequenciesThatTheRateCannotCarry) {
  const auto stamps = uneven_stamps(1000);
  EXPECT_EQ(error_of(stamps, values_of(Signal{}, stamps), "501"),
            ErrorCode::frequency_out_of_range);
  const auto even = [](int i) {
    return epoch_ns + i * 1'000'000LL + (i >= 500 ? 7'000'000'000 : 0);
  }; // with a gap
  std::vector<std::int64_t> gappy(1000);
  for (int i = 0; i < 1000; ++i) {
    gappy[static_cast<std::size_t>(i)] = even(i);
  }
  for (const char* frequency_hz : {"500.5", "920", "1080", "1e4"}) {
    EXPECT_EQ(error_of(gappy, values_of(Signal{}, gappy), frequency_hz),
              ErrorCode::frequency_out_of_range)
        << frequency_hz;
  }
}

TEST(SineFit, RefusesARecordWithoutExcitation) {
  const auto stamps = uneven_stamps(1000);
  for (const double level : {0.0, 5.0, 0.1, -1e9}) {
    EXPECT_EQ(error_of(stamps, std::vector<double>(1000, level)), ErrorCode::no_excitation)
        << level;
  }
  std::mt19937_64 random(2);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<double> values(1000);
  for (double& y : values) {
    y = noise(random);
  }
  EXPECT_EQ(error_of(stamps, values), ErrorCode::no_excitation);
}

TEST(SineFit, RefusesPhasesThatCannotBeToldApart) {
  std::vector<std::int64_t> stroboscopic;
  for (int i = 0; i < 1000; ++i) {
    stroboscopic.push_back(epoch_ns + i * 12'500'000LL); // 80 Hz exactly, seen at 80 Hz
  }
  std::vector<double> values(1000);
  for (std::size_t i = 0; i < 1000; ++i) {
    values[i] = static_cast<double>(i % 7);
  }
  EXPECT_EQ(error_of(stroboscopic, values, "40"), ErrorCode::ill_conditioned);
  const auto stamps = uneven_stamps(1000);
  EXPECT_EQ(error_of(stamps, values, "0.001"), ErrorCode::ill_conditioned);
}

TEST(SineFit, RefusesSizesThatContradict) {
  const auto stamps = uneven_stamps(100);
  EXPECT_EQ(error_of(stamps, std::vector<double>(99, 1.0)), ErrorCode::invalid_argument);
  const auto none = fit_sine(*Frequency::parse("80"), epoch_ns, stamps, {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::invalid_argument);
  const std::vector<std::int64_t> lifetime = {0, 1, 2, 3, 86'400'000'000'000 * 40};
  EXPECT_EQ(error_of(lifetime, std::vector<double>(5, 1.0), "1e-7"), ErrorCode::invalid_argument);
}

} // namespace
} // namespace dyncal::analysis
