#include "analysis/method/blocks_of_clock.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

using Complex = std::complex<double>;

constexpr double pi = std::numbers::pi;
constexpr double rate_hz = 1000.0;
constexpr std::size_t samples = 3000;
constexpr double amplitude = 10.0;
constexpr double sd = 0.1;

std::vector<std::int64_t> stamps() {
  std::vector<std::int64_t> result;
  for (std::size_t i = 0; i < samples; ++i) {
    result.push_back(1'000'000 * static_cast<std::int64_t>(i));
  }
  return result;
}

using Random = std::mt19937_64;
using Noise = std::function<std::vector<double>(Random&)>;

std::vector<double> white(Random& random) {
  std::normal_distribution<double> normal;
  std::vector<double> values(samples);
  std::generate(values.begin(), values.end(), [&] { return sd * normal(random); });
  return values;
}

// x_i = keeps x_{i-1} + e_i
Noise autoregressive(double keeps) {
  return [keeps](Random& random) {
    std::normal_distribution<double> normal;
    std::vector<double> values;
    double value = sd * normal(random);
    for (std::size_t i = 0; i < samples; ++i) {
      values.push_back(value);
      value = keeps * value + std::sqrt(1.0 - keeps * keeps) * sd * normal(random);
    }
    return values;
  };
}

Noise narrow_band(double centre_hz, double width_hz) {
  return [=](Random& random) {
    std::normal_distribution<double> normal;
    const double keeps = std::exp(-pi * width_hz / rate_hz);
    std::vector<double> values = white(random);
    Complex slow{normal(random), normal(random)};
    for (std::size_t i = 0; i < samples; ++i) {
      const double turns = centre_hz * static_cast<double>(i) / rate_hz;
      values[i] += sd * (slow * std::polar(1.0, 2.0 * pi * turns)).real();
      slow =
          keeps * slow + std::sqrt(1.0 - keeps * keeps) * Complex{normal(random), normal(random)};
    }
    return values;
  };
}

Noise line(double hz, double size) {
  return [=](Random& random) {
    std::uniform_real_distribution<double> turns(0.0, 1.0);
    const double begin = turns(random);
    std::vector<double> values = white(random);
    for (std::size_t i = 0; i < samples; ++i) {
      values[i] += size * sd * std::sin(2.0 * pi * (begin + hz * static_cast<double>(i) / rate_hz));
    }
    return values;
  };
}

struct Case {
  std::string name;
  double frequency_hz;
  Noise noise;
  double widest = 1.5; // usual U over 2 rms of the errors
};

void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

class FrequencyOfClock : public testing::TestWithParam<Case> {};

// 300 draws: 95.45 % less two standard deviations of what chance does is 93.0 %.
TEST_P(FrequencyOfClock, IsCoveredByItsUncertainty) {
  constexpr int draws = 300;
  const Case& one = GetParam();
  Random random(5);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  const std::vector<std::int64_t> stamps_ns = stamps();
  int covered = 0, evaluated = 0;
  double squares = 0.0;
  std::vector<double> all_u;
  for (int i = 0; i < draws; ++i) {
    const double hz = one.frequency_hz * (1.0 + 1e-5 * part(random));
    const double phase_rad = pi * part(random);
    std::vector<double> values = one.noise(random);
    for (std::size_t k = 0; k < samples; ++k) {
      values[k] +=
          amplitude * std::sin(2.0 * pi * hz * static_cast<double>(k) / rate_hz + phase_rad);
    }
    auto system = fit_channels_of_one_clock(Frequency::from_hz(one.frequency_hz), 1e-3, stamps_ns,
                                            {"sync", values}, {});
    ASSERT_TRUE(system.has_value()) << system.error().message;
    learn_frequency_noise(*system);
    const ChannelFit& fit = system->pilot.result;
    const double error_hz = fit.frequency.hz() - hz;
    covered += std::abs(error_hz) <= 2.0 * fit.u_frequency_hz ? 1 : 0;
    squares += error_hz * error_hz / draws;
    all_u.push_back(fit.u_frequency_hz);
    ++evaluated;
  }
  ASSERT_EQ(evaluated, draws);
  std::nth_element(all_u.begin(), all_u.begin() + draws / 2, all_u.end());
  const double width = all_u[draws / 2] / std::sqrt(squares);
  EXPECT_GE(covered, 0.93 * draws) << width;
  EXPECT_GT(width, 0.85);
  EXPECT_LT(width, one.widest) << covered;
}

INSTANTIATE_TEST_SUITE_P(
    Noises, FrequencyOfClock,
    testing::Values(Case{"white", 40.0, white, 1.2}, Case{"white_of_few_periods", 1.7, white, 1.2},
                    Case{"memory_at_5_Hz", 5.0, autoregressive(0.95)},
                    Case{"long_memory_at_5_Hz", 5.0, autoregressive(0.99)},
                    Case{"long_memory_at_40_Hz", 40.0, autoregressive(0.99)},
                    Case{"longest_memory_at_80_Hz", 80.0, autoregressive(0.999)},
                    Case{"hum", 47.3, line(50.0, 10.0)},
                    Case{"another_line", 47.3, line(61.3, 10.0), 3.0},
                    Case{"a_line_nearby", 47.3, line(45.1, 3.0), 3.0},
                    Case{"narrow_band_at_the_sine", 40.0, narrow_band(40.0, 3.0), 2.0},
                    Case{"narrow_band_beside_the_sine", 40.0, narrow_band(43.0, 3.0), 2.0},
                    Case{"narrow_band_below_the_sine", 80.0, narrow_band(72.0, 5.0), 2.0}),
    [](const auto& one) { return one.param.name; });

// What is known exactly stays so, and so does the frequency itself.
TEST(BlocksOfClock, LearnsOnlyTheUncertaintyOfTheFrequency) {
  Random random(6);
  const std::vector<std::int64_t> stamps_ns = stamps();
  std::vector<double> values = autoregressive(0.99)(random);
  for (std::size_t k = 0; k < samples; ++k) {
    values[k] += amplitude * std::sin(2.0 * pi * 5.0 * static_cast<double>(k) / rate_hz);
  }
  for (const double search_rel : {0.0, 1e-3}) {
    auto system = fit_channels_of_one_clock(Frequency::from_hz(5.0), search_rel, stamps_ns,
                                            {"sync", values}, {});
    ASSERT_TRUE(system.has_value()) << system.error().message;
    const ChannelFit before = system->pilot.result;
    learn_frequency_noise(*system);
    const ChannelFit& after = system->pilot.result;
    EXPECT_EQ(after.frequency.hz(), before.frequency.hz());
    EXPECT_EQ(after.fit.sine, before.fit.sine);
    EXPECT_EQ(after.u_frequency_hz > before.u_frequency_hz, search_rel > 0.0);
    EXPECT_EQ(after.u_frequency_hz > 0.0, search_rel > 0.0);
  }
}

} // namespace
} // namespace dyncal::analysis
