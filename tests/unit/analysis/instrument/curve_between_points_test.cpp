#include "analysis/instrument/curve_between_points.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

struct Response {
  std::vector<double> frequencies_hz, magnitudes, phases_rad;
};

double high_pass_magnitude(double hz, double corner_hz) {
  return 1.0 / std::hypot(1.0, corner_hz / hz);
}

Response high_pass(const std::vector<double>& frequencies_hz, double corner_hz) {
  Response result{frequencies_hz, {}, {}};
  for (const double hz : frequencies_hz) {
    result.magnitudes.push_back(high_pass_magnitude(hz, corner_hz));
    result.phases_rad.push_back(std::atan(corner_hz / hz));
  }
  return result;
}

// 2 / sqrt(3) of the half width is U.
double expanded(const CurveValue& curve) {
  return 2.0 * curve.missed / std::numbers::sqrt3;
}

TEST(CurveBetweenPoints, IsExactAtThePointsAndOnALine) {
  const std::vector<double> hz{10.0, 20.0, 50.0, 80.0};
  const std::vector<double> values{1.0, 1.1, 1.4, 1.7};
  for (const double at : {10.0, 14.0, 20.0, 30.0, 50.0, 79.0}) {
    const std::size_t i = at < 20.0 ? 0 : at < 50.0 ? 1 : 2;
    const CurveValue curve = curve_between_points(hz, values, i, at);
    EXPECT_NEAR(curve.value, 0.9 + at / 100.0, 1e-14);
    EXPECT_NEAR(curve.missed, 0.0, 1e-14);
  }
}

TEST(CurveBetweenPoints, HighPassesAreCoveredInEveryInterval) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> part;
  for (int draw = 0; draw < 300; ++draw) {
    std::vector<double> hz{2.0 + 10.0 * part(random)};
    const int count = 3 + draw % 5;
    const double ratio = 1.2 + 0.9 * part(random);
    while (static_cast<int>(hz.size()) < count) {
      hz.push_back(hz.back() * ratio);
    }
    const double corner_hz = 0.05 * std::pow(10.0, part(random)) * hz.front();
    const Response table = high_pass(hz, corner_hz);
    for (std::size_t i = 0; i + 1 < hz.size(); ++i) {
      const double at = hz[i] + part(random) * (hz[i + 1] - hz[i]);
      const CurveValue magnitude = curve_between_points(hz, table.magnitudes, i, at);
      const CurveValue phase = curve_between_points(hz, table.phases_rad, i, at);
      EXPECT_LE(std::abs(magnitude.value - high_pass_magnitude(at, corner_hz)), expanded(magnitude))
          << count << " points, interval " << i;
      EXPECT_LE(std::abs(phase.value - std::atan(corner_hz / at)), expanded(phase))
          << count << " points, interval " << i;
    }
  }
}

// 1 Hz with points at 10, 20 and 40 Hz: 8.5e-3 rad with U 3.4e-3 when only one neighbour counted.
TEST(CurveBetweenPoints, TheFirstIntervalOfThreePointsIsCoveredAndNotMuchMore) {
  const Response table = high_pass({10.0, 20.0, 40.0}, 1.0);
  const CurveValue phase = curve_between_points(table.frequencies_hz, table.phases_rad, 0, 14.0);
  const double error = std::abs(phase.value - std::atan(1.0 / 14.0));
  EXPECT_GT(error, 1e-3);
  EXPECT_LE(error, expanded(phase));
  EXPECT_LE(expanded(phase), 3.0 * error);
}

TEST(CurveBetweenPoints, ASmoothTableIsNotBlownUp) {
  std::vector<double> hz, phases;
  for (int i = 0; i < 20; ++i) {
    hz.push_back(10.0 * std::pow(10.0, 0.1 * i));
    phases.push_back(-std::atan(hz.back() / 5000.0));
  }
  for (std::size_t i = 1; i + 2 < hz.size(); ++i) {
    const double at = std::sqrt(hz[i] * hz[i + 1]);
    const CurveValue curve = curve_between_points(hz, phases, i, at);
    const double error = std::abs(curve.value + std::atan(at / 5000.0));
    EXPECT_LE(error, expanded(curve));
    EXPECT_LE(expanded(curve), 4.0 * error + 1e-9) << at;
  }
}

struct WaveCoverage {
  double inner = 0.0, ends = 0.0; // parts of the intervals
  double widest = 0.0;
};

// Of waves over the logarithm of the frequency, in tables of octaves.
WaveCoverage wave_coverage(double points_a_period, std::size_t count, unsigned seed) {
  constexpr int draws = 400;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part;
  const double turns = 2.0 * pi / (points_a_period * std::numbers::ln2);
  std::vector<double> hz{10.0};
  while (hz.size() < count) {
    hz.push_back(2.0 * hz.back());
  }
  WaveCoverage result;
  for (int draw = 0; draw < draws; ++draw) {
    const double begin = 2.0 * pi * part(random);
    const auto wave = [&](double at) { return std::sin(turns * std::log(at) + begin); };
    std::vector<double> values;
    std::transform(hz.begin(), hz.end(), std::back_inserter(values), wave);
    for (std::size_t i = 0; i + 1 < count; ++i) {
      const double at = hz[i] * std::pow(2.0, 0.1 + 0.8 * part(random));
      const CurveValue curve = curve_between_points(hz, values, i, at);
      const bool covered = std::abs(curve.value - wave(at)) <= expanded(curve);
      const bool is_end = i == 0 || i + 2 == count;
      const double of = draws * (is_end ? 2.0 : static_cast<double>(count - 3));
      (is_end ? result.ends : result.inner) += covered ? 1.0 / of : 0.0;
      result.widest = std::max(result.widest, expanded(curve));
    }
  }
  return result;
}

// Of 6 points a period only 61 % were covered at the ends, the worst by 94 times too little; of 4.5
// points 93 %, the worst by 24 times.
TEST(CurveBetweenPoints, ACurveThatTurnsBackBetweenItsPointsIsCovered) {
  for (const unsigned seed : {21U, 22U, 23U}) {
    for (const double points_a_period : {4.0, 4.5, 5.0, 6.0, 8.0}) {
      for (const std::size_t count : {5U, 6U, 10U}) {
        const WaveCoverage coverage = wave_coverage(points_a_period, count, seed);
        const std::string what = std::to_string(points_a_period) + " points a period, " +
                                 std::to_string(count) + " points, seed " + std::to_string(seed);
        EXPECT_LT(coverage.widest, 3.0) << what; // not more than the wave is high, and half of it
        EXPECT_GT(coverage.inner, 0.965) << what;
        EXPECT_GT(coverage.ends, 0.955) << what;
      }
    }
  }
}

// Sensitivities as certificates state them: a high pass below, a resonance far above.
double sensitivity(double hz, double corner_hz, double resonance_hz) {
  const double ratio = hz / resonance_hz;
  return high_pass_magnitude(hz, corner_hz) / std::hypot(1.0 - ratio * ratio, 0.06 * ratio);
}

// U is seldom many times what a straight line misses at most in an interval, but where the curve
// has its point of inflection and is as good as straight.
TEST(CurveBetweenPoints, SmoothSensitivitiesAreCoveredAndNotTakenForWaves) {
  for (const unsigned seed : {31U, 32U}) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> part;
    int covered = 0, intervals = 0, bent = 0, wide = 0;
    for (int draw = 0; draw < 300; ++draw) {
      const double corner_hz = 3.0 * part(random);
      const double resonance_hz = std::pow(10.0, 3.3 + part(random));
      std::vector<double> hz, values;
      const int count = 5 + draw % 16;
      for (int i = 0; i < count; ++i) {
        hz.push_back(10.0 * std::pow(100.0, static_cast<double>(i) / (count - 1)));
        values.push_back(sensitivity(hz.back(), corner_hz, resonance_hz));
      }
      std::vector<double> missed, stated; // of each interval: at most, and U there
      for (std::size_t i = 0; i + 1 < hz.size(); ++i) {
        missed.push_back(0.0);
        stated.push_back(0.0);
        for (double weight = 0.05; weight < 1.0; weight += 0.05) {
          const double at = hz[i] + weight * (hz[i + 1] - hz[i]);
          const CurveValue curve = curve_between_points(hz, values, i, at);
          const double error = std::abs(curve.value - sensitivity(at, corner_hz, resonance_hz));
          covered += error <= expanded(curve) ? 1 : 0;
          ++intervals;
          missed.back() = std::max(missed.back(), error);
          stated.back() = std::max(stated.back(), expanded(curve));
        }
      }
      const double most = *std::max_element(missed.begin(), missed.end());
      for (std::size_t i = 0; i < missed.size(); ++i) {
        const bool is_bent = missed[i] > 0.1 * most;
        bent += is_bent ? 1 : 0;
        wide += is_bent && stated[i] > 4.0 * missed[i] ? 1 : 0;
      }
    }
    EXPECT_GT(covered, 0.97 * intervals) << seed;
    EXPECT_GT(bent, 300) << seed;
    EXPECT_LT(wide, 0.05 * bent) << seed;
  }
}

TEST(CurveBetweenPoints, OfTwoPointsBothLinesAreLikely) {
  const std::vector hz{10.0, 40.0};
  const CurveValue curve = curve_between_points(hz, std::vector{1.0, 1.2}, 0, 20.0);
  EXPECT_NEAR(curve.value, 1.0 + 0.2 / 3.0, 1e-12);
  const double over_logarithm = 1.1;
  EXPECT_NEAR(curve.missed, 2.0 * (over_logarithm - curve.value), 1e-12);
  EXPECT_EQ(curve_between_points(hz, std::vector{1.0, 1.0}, 0, 20.0).missed, 0.0);
}

TEST(UnwrapOverFrequency, NeighboursOfHalfATurnAreClose) {
  const std::vector<double> hz{20.0, 50.0, 80.0, 160.0};
  const double degree = pi / 180.0;
  const auto unwrapped = unwrap_over_frequency(
      hz, std::vector{179.9 * degree, -179.8 * degree, 179.7 * degree, -179.0 * degree});
  EXPECT_NEAR(unwrapped.phases_rad[1], 180.2 * degree, 1e-12);
  EXPECT_NEAR(unwrapped.phases_rad[2], 179.7 * degree, 1e-12);
  EXPECT_NEAR(unwrapped.phases_rad[3], 181.0 * degree, 1e-12);
  EXPECT_EQ(unwrapped.ambiguous, std::vector<bool>(3, false));
}

TEST(UnwrapOverFrequency, FollowsADelayOverStepsOfMoreThanHalfATurn) {
  std::vector<double> hz, phases;
  for (double f = 100.0; f < 7000.0; f *= 2.0) {
    hz.push_back(f);
    phases.push_back(wrap_phase(-2.0 * pi * f * 1e-3 + 1e-3 * std::sin(f)));
  }
  const auto unwrapped = unwrap_over_frequency(hz, phases);
  EXPECT_NEAR(unwrapped.phases_rad.back(), -2.0 * pi * hz.back() * 1e-3, 2e-3);
  EXPECT_EQ(unwrapped.ambiguous, std::vector<bool>(hz.size() - 1, false));
}

TEST(UnwrapOverFrequency, SaysWhereTheTableDoesNotTell) {
  const auto unwrapped =
      unwrap_over_frequency(std::vector{100.0, 200.0, 300.0}, std::vector{0.0, 3.0, 2.9});
  EXPECT_TRUE(unwrapped.ambiguous[0]);
  EXPECT_NEAR(ambiguous_phase_rad(0.5), pi, 1e-12);
  EXPECT_EQ(ambiguous_phase_rad(0.0), 0.0);
}

} // namespace
} // namespace dyncal::analysis
