#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/sine/sine_fit.hpp"
#include "tests/unit/analysis/sine/sine_signal.hpp"

namespace dyncal::analysis {
namespace {

Expected<FrequencyFit> fit_one(const std::string& start_hz, double search_rel,
                               const std::vector<std::int64_t>& stamps,
                               const std::vector<double>& values) {
  const std::span<const double> channels[] = {values};
  return fit_sine_and_frequency(*Frequency::parse(start_hz), search_rel, epoch_ns, stamps,
                                channels);
}

double span_s(const std::vector<std::int64_t>& stamps) {
  return static_cast<double>(stamps.back() - stamps.front()) * 1e-9;
}

double wrapped(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}

TEST(SineFrequencyFit, FindsPureSineToRounding) {
  for (const std::size_t samples : {60U, 400U, 3000U, 9000U, 60'000U}) {
    Signal signal;
    signal.frequency_hz = "80.013";
    const auto stamps = uneven_stamps(samples);
    const auto fit = fit_one("80", 1e-3, stamps, values_of(signal, stamps));
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_NEAR((fit->frequency.hz() - 80.013) * 2.0 * std::numbers::pi * span_s(stamps), 0.0,
                1e-11)
        << samples;
    EXPECT_NEAR(fit->channels[0].amplitude(), signal.amplitude, 1e-12) << samples;
    EXPECT_NEAR(fit->channels[0].phase_rad(), signal.phase_rad, 1e-11) << samples;
  }
}

// The first sample is the start value of the constant, and the start frequency may be nearly right:
// wherever in the period the record begins, the fit arrives.
TEST(SineFrequencyFit, DoesNotDependOnWhereTheFirstSampleLies) {
  for (const std::size_t samples : {60U, 400U, 1000U, 3000U, 8000U}) {
    const auto stamps = uneven_stamps(samples);
    for (const double distance_rad : {5e-5, 2e-4, 1e-3, 3e-3, 1e-2}) { // over half the record
      const double hz = 80.0 + distance_rad / (std::numbers::pi * span_s(stamps));
      for (int part = 0; part < 16; ++part) {
        Signal signal;
        signal.frequency_hz = std::to_string(hz);
        signal.phase_rad = wrapped(2.0 * std::numbers::pi * part / 16.0);
        const auto fit = fit_one("80", 1e-4, stamps, values_of(signal, stamps));
        ASSERT_TRUE(fit) << fit.error().message;
        EXPECT_NEAR((fit->frequency.hz() - std::stod(signal.frequency_hz)) * 2.0 *
                        std::numbers::pi * span_s(stamps),
                    0.0, 1e-11)
            << samples << ", " << distance_rad << " rad away, part " << part;
        EXPECT_NEAR(wrapped(fit->channels[0].phase_rad() - signal.phase_rad), 0.0, 1e-11)
            << samples << ", " << distance_rad << " rad away, part " << part;
      }
    }
  }
}

TEST(SineFrequencyFit, ArrivesFromManyBinsAway) {
  Signal signal;
  const auto stamps = uneven_stamps(30'000);
  for (const char* frequency_hz :
       {"79.6", "79.97", "80.0", "80.0166", "80.05", "80.2432", "80.39"}) {
    signal.frequency_hz = frequency_hz;
    const auto fit = fit_one("80", 5e-3, stamps, noisy(values_of(signal, stamps), 0.1, 3));
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_NEAR(fit->frequency.hz(), std::stod(frequency_hz), 5.0 * fit->u_frequency_hz)
        << frequency_hz;
  }
}

TEST(SineFrequencyFit, FindsASineBelowTheNoise) {
  Signal signal;
  signal.frequency_hz = "80.2";
  signal.amplitude = 0.1;
  const auto stamps = uneven_stamps(100'000);
  const auto fit = fit_one("80", 5e-3, stamps, noisy(values_of(signal, stamps), 1.0, 8));
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->frequency.hz(), 80.2, 5.0 * fit->u_frequency_hz);
}

TEST(SineFrequencyFit, HoldsBelowThreeCyclesAndWithGaps) {
  for (const char* frequency_hz : {"1.1", "1.37", "1.9", "2.8"}) {
    Signal signal;
    signal.frequency_hz = frequency_hz;
    const auto stamps = uneven_stamps(1000);
    const auto fit = fit_one("1.5", 0.9, stamps, noisy(values_of(signal, stamps), 0.01, 4));
    ASSERT_TRUE(fit) << frequency_hz << ' ' << fit.error().message;
    EXPECT_NEAR(fit->frequency.hz(), std::stod(frequency_hz), 5.0 * fit->u_frequency_hz)
        << frequency_hz;
  }
  Signal signal;
  signal.frequency_hz = "80.12";
  auto stamps = uneven_stamps(20'000);
  for (std::size_t i = 6000; i < stamps.size(); ++i) {
    stamps[i] += 7'000'000'000 + (i > 13'000 ? 20'000'000'000 : 0);
  }
  const auto fit = fit_one("80", 4e-3, stamps, noisy(values_of(signal, stamps), 0.05, 5));
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->frequency.hz(), 80.12, 5.0 * fit->u_frequency_hz);
}

TEST(SineFrequencyFit, ReachesTheMinimumOfTheResiduals) {
  Signal signal;
  signal.frequency_hz = "80.031";
  for (const std::size_t samples : {300U, 2500U, 40'000U}) {
    const auto stamps = uneven_stamps(samples);
    const auto values = noisy(values_of(signal, stamps), 0.2, 6);
    const std::span<const double> channels[] = {values};
    const auto fit = fit_one("80", 1e-3, stamps, values);
    ASSERT_TRUE(fit) << fit.error().message;
    // Symmetric three-parameter fits beside the result: the vertex of the parabola is where the
    // result says.
    const double step = 3.0 * fit->u_frequency_hz;
    const auto rss = [&](double shift) {
      return fit_sine(fit->frequency.shifted_by_hz(shift), epoch_ns, stamps, channels)->front().rss;
    };
    const double vertex =
        0.5 * step * (rss(-step) - rss(step)) / (rss(-step) - 2.0 * rss(0.0) + rss(step));
    EXPECT_LT(std::abs(vertex), 1e-2 * fit->u_frequency_hz)
        << samples; // the residuals are not quite a parabola
    EXPECT_NEAR(rss(0.0) / fit->channels[0].rss, 1.0, 1e-11);
    EXPECT_NEAR(fit_sine(fit->frequency, epoch_ns, stamps, channels)->front().sine,
                fit->channels[0].sine, 1e-11);
  }
}

TEST(SineFrequencyFit, StatesTheScatterOfItsResults) {
  Signal signal;
  signal.frequency_hz = "80.1";
  const auto stamps = uneven_stamps(300);
  const auto clean = values_of(signal, stamps);
  constexpr int trials = 1000;
  int frequency_inside = 0;
  int phase_inside = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const auto fit =
        fit_one("80", 5e-3, stamps, noisy(clean, 0.1, static_cast<unsigned>(100 + trial)));
    ASSERT_TRUE(fit) << fit.error().message;
    frequency_inside += std::abs(fit->frequency.hz() - 80.1) < 2.0 * fit->u_frequency_hz ? 1 : 0;
    phase_inside += std::abs(fit->channels[0].phase_rad() - signal.phase_rad) <
                            2.0 * fit->channels[0].u_phase_rad()
                        ? 1
                        : 0;
  }
  EXPECT_NEAR(static_cast<double>(frequency_inside) / trials, 0.9545, 0.02);
  EXPECT_NEAR(static_cast<double>(phase_inside) / trials, 0.9545, 0.02);
}

TEST(SineFrequencyFit, LetsChannelsCountByTheirNoise) {
  const auto stamps = uneven_stamps(4000);
  Signal good;
  good.frequency_hz = "80.02";
  Signal coarse = good;
  coarse.amplitude = 16'384.0; // the same quality in other units
  const auto first = noisy(values_of(good, stamps), 0.01, 1);
  const auto second = noisy(values_of(coarse, stamps), 0.01 * 16'384.0 / 1.25, 2);
  const std::span<const double> channels[] = {first, second};
  const auto both =
      fit_sine_and_frequency(*Frequency::parse("80"), 1e-3, epoch_ns, stamps, channels);
  const auto one = fit_one("80", 1e-3, stamps, first);
  ASSERT_TRUE(both && one);
  EXPECT_NEAR(one->u_frequency_hz / both->u_frequency_hz, std::numbers::sqrt2, 0.05);
}

TEST(SineFrequencyFit, GivesTheSameBitsAgain) {
  Signal signal;
  signal.frequency_hz = "80.07";
  const auto stamps = uneven_stamps(20'000);
  const auto values = noisy(values_of(signal, stamps), 0.1, 3);
  const auto a = fit_one("80", 5e-3, stamps, values);
  const auto b = fit_one("80", 5e-3, stamps, values);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->frequency.hz(), b->frequency.hz());
  EXPECT_EQ(a->channels[0].sine, b->channels[0].sine);
}

TEST(SineFrequencyFit, NamesWhatIsWrongWithTheInput) {
  const auto stamps = uneven_stamps(2000);
  const auto good = values_of(Signal{}, stamps);
  const auto code = [&](const Expected<FrequencyFit>& fit) {
    EXPECT_FALSE(fit.has_value());
    return fit ? ErrorCode{} : fit.error().code;
  };
  const auto few = uneven_stamps(4);
  EXPECT_EQ(code(fit_one("80", 1e-3, few, values_of(Signal{}, few))), ErrorCode::too_few_samples);
  auto values = good;
  values[1234] = std::nan("");
  EXPECT_EQ(code(fit_one("80", 1e-3, stamps, values)), ErrorCode::not_finite);
  auto backward = stamps;
  backward[700] = backward[699];
  EXPECT_EQ(code(fit_one("80", 1e-3, backward, good)), ErrorCode::stamps_not_increasing);
  EXPECT_EQ(code(fit_one("600", 1e-3, stamps, good)), ErrorCode::frequency_out_of_range);
  EXPECT_EQ(code(fit_one("80", -1.0, stamps, good)), ErrorCode::invalid_argument);
  EXPECT_EQ(code(fit_one("80", 1.5, stamps, good)), ErrorCode::invalid_argument);
  EXPECT_EQ(code(fit_one("80", 1e-3, stamps, std::vector<double>(2000, 5.0))),
            ErrorCode::ill_conditioned);
  const ErrorCode noise =
      code(fit_one("80", 1e-2, stamps, noisy(std::vector<double>(2000, 0.0), 1.0, 12)));
  EXPECT_TRUE(noise == ErrorCode::no_excitation || noise == ErrorCode::not_converged);
}

} // namespace
} // namespace dyncal::analysis
