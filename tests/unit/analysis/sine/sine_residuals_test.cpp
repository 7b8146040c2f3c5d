#include "analysis/sine/sine_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

const Frequency frequency = *Frequency::parse("46.7");

// Two channels on uneven stamps: sine, second harmonic, a 100 Hz line, drift and noise.
struct Recorded {
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::vector<double>> values{2};
  std::vector<std::span<const double>> channels;
  std::vector<SineFit> fits; // about the middle

  explicit Recorded(std::size_t samples, double drift = 0.0) {
    std::mt19937_64 random(9);
    std::normal_distribution<double> noise(0.0, 1e-2);
    std::uniform_int_distribution<std::int64_t> late(0, 30'000);
    for (std::size_t i = 0; i < samples; ++i) {
      stamps_ns.push_back(1'000'000'000'000 + 200'000 * static_cast<std::int64_t>(i) +
                          late(random));
      const double t = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
      const double turn = 2.0 * std::numbers::pi * t;
      for (std::size_t j = 0; j < values.size(); ++j) {
        const double size = 1.0 + static_cast<double>(j);
        values[j].push_back(size * std::sin(46.7 * turn + 0.3) + 0.03 * std::cos(93.4 * turn) +
                            0.02 * std::sin(100.0 * turn) + drift * t + 5.0 + noise(random));
      }
    }
    channels.assign(values.begin(), values.end());
    fits = *fit_sine(frequency, middle_of_record_ns(stamps_ns), stamps_ns, channels);
  }

  [[nodiscard]] std::vector<double> residuals(std::size_t channel, double slope = 0.0) const {
    std::vector<double> result;
    for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
      const std::int64_t ns = stamps_ns[i] - middle_of_record_ns(stamps_ns);
      const double x = 2.0 * std::numbers::pi * frequency.reduced_turns(ns);
      result.push_back(values[channel][i] - fits[channel].offset -
                       fits[channel].sine * std::sin(x) - fits[channel].cosine * std::cos(x) -
                       slope * u(i));
    }
    return result;
  }
  [[nodiscard]] double u(std::size_t i) const {
    const double half = 0.5 * static_cast<double>(stamps_ns.back() - stamps_ns.front());
    return static_cast<double>(stamps_ns[i] - middle_of_record_ns(stamps_ns)) / half;
  }
};

ResidualSearch search_of_lines() {
  return {.first = {frequency, 2, 9},
          .others = {{Frequency::from_hz(50.0), 1, 3}, {Frequency::from_hz(60.0), 1, 3}}};
}

void expect_line(const std::optional<ResidualLine>& line, const Recorded& recorded,
                 const std::vector<double>& residuals, const Frequency& of_line) {
  const std::span<const double> channel[] = {residuals};
  const auto expected =
      fit_sine(of_line, middle_of_record_ns(recorded.stamps_ns), recorded.stamps_ns, channel);
  ASSERT_TRUE(line);
  if (!expected) {
    EXPECT_EQ(expected.error().code, ErrorCode::no_excitation);
    EXPECT_LT(line->fit.amplitude(), 4.0 * line->fit.u_amplitude());
    return;
  }
  EXPECT_NEAR(line->fit.sine, expected->front().sine, 1e-13);
  EXPECT_NEAR(line->fit.cosine, expected->front().cosine, 1e-13);
  EXPECT_NEAR(line->fit.u_amplitude(), expected->front().u_amplitude(), 1e-13);
  EXPECT_NEAR(line->fit.rss, expected->front().rss, 1e-11 * expected->front().rss);
}

TEST(SineResiduals, FitEveryLineAsASineFitOfTheResidualsDoes) {
  for (const std::size_t samples : {100UL, 512UL, 1283UL, 5001UL}) {
    const Recorded recorded(samples);
    const ResidualSearch search = search_of_lines();
    const auto reduced =
        reduce_residuals(search, recorded.stamps_ns, recorded.channels, recorded.fits);
    ASSERT_TRUE(reduced);
    for (std::size_t j = 0; j < 2; ++j) {
      const std::vector<double> residuals = recorded.residuals(j);
      const ChannelResiduals& channel = (*reduced)[j];
      ASSERT_EQ(channel.lines.size(), 3U);
      for (int k = 0; k < 9; ++k) {
        expect_line(channel.lines[0][static_cast<std::size_t>(k)], recorded, residuals,
                    frequency.multiple(k + 2));
      }
      for (int k = 0; k < 3; ++k) {
        expect_line(channel.lines[1][static_cast<std::size_t>(k)], recorded, residuals,
                    Frequency::from_hz(50.0 * (k + 1)));
        expect_line(channel.lines[2][static_cast<std::size_t>(k)], recorded, residuals,
                    Frequency::from_hz(60.0 * (k + 1)));
      }
    }
  }
}

TEST(SineResiduals, SumWhatADriftNeeds) {
  const Recorded recorded(3001, 0.1);
  const auto reduced = reduce_residuals({.first = {frequency, 2, 9}}, recorded.stamps_ns,
                                        recorded.channels, recorded.fits);
  ASSERT_TRUE(reduced);
  const std::vector<double> residuals = recorded.residuals(1);
  TimeSums expected;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    for (std::size_t m = 0; m < expected.u.size(); ++m) {
      expected.u[m] += std::pow(recorded.u(i), static_cast<double>(m));
    }
    for (std::size_t m = 0; m < expected.eu.size(); ++m) {
      expected.eu[m] += residuals[i] * std::pow(recorded.u(i), static_cast<double>(m));
    }
    expected.ee += residuals[i] * residuals[i];
  }
  const TimeSums& sums = (*reduced)[1].time;
  EXPECT_EQ(sums.samples, 3001.0);
  for (std::size_t m = 0; m < expected.u.size(); ++m) {
    EXPECT_NEAR(sums.u[m], expected.u[m], 1e-9) << m;
  }
  for (std::size_t m = 0; m < expected.eu.size(); ++m) {
    EXPECT_NEAR(sums.eu[m], expected.eu[m], 1e-10) << m;
  }
  EXPECT_NEAR(sums.ee, expected.ee, 1e-11 * expected.ee);
  EXPECT_GT(std::abs(expected.eu[1]), 1.0); // else nothing was shown
}

TEST(SineResiduals, LinesAreThoseWithoutTheDriftThatIsGiven) {
  const Recorded recorded(3001, 0.5);
  const std::vector<double> slope{0.15};
  const std::vector<std::span<const double>> drifts{{}, slope};
  ResidualSearch search = search_of_lines();
  search.drifts = drifts;
  const auto reduced =
      reduce_residuals(search, recorded.stamps_ns, recorded.channels, recorded.fits);
  ASSERT_TRUE(reduced);
  expect_line((*reduced)[0].lines[0][0], recorded, recorded.residuals(0), frequency.multiple(2));
  expect_line((*reduced)[1].lines[0][0], recorded, recorded.residuals(1, 0.15),
              frequency.multiple(2));
}

TEST(SineResiduals, ShowTheRangeOfEveryBlockAndWhereValuesRepeat) {
  Recorded recorded(1283);
  recorded.values[0][700] = recorded.values[0][701];
  recorded.values[1][1282] = recorded.values[1][1281];
  const auto reduced = reduce_residuals({.first = {frequency, 2, 9}}, recorded.stamps_ns,
                                        recorded.channels, recorded.fits);
  ASSERT_TRUE(reduced);
  for (std::size_t j = 0; j < 2; ++j) {
    const PlainChannel plain = plain_channel(recorded.fits[j], {frequency, 2, 9}, (*reduced)[j]);
    EXPECT_EQ(plain.harmonics.size(), 9U);
    EXPECT_EQ(plain.harmonics.front().order, 2);
    ASSERT_EQ(plain.blocks.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto begin = recorded.values[j].begin() + static_cast<std::ptrdiff_t>(512 * k);
      const auto end = recorded.values[j].begin() +
                       static_cast<std::ptrdiff_t>(std::min<std::size_t>(512 * (k + 1), 1283));
      EXPECT_EQ(plain.blocks[k].low, *std::min_element(begin, end));
      EXPECT_EQ(plain.blocks[k].high, *std::max_element(begin, end));
      EXPECT_EQ(plain.blocks[k].repeats, std::adjacent_find(begin, end) != end);
    }
    EXPECT_TRUE(plain.blocks[j == 0 ? 1 : 2].repeats);
  }
}

} // namespace
} // namespace dyncal::analysis
