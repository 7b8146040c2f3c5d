#include "analysis/interferometer/ellipse_fit.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/interferometer/record_ellipse.hpp"
#include "tests/unit/analysis/interferometer/simulated_interferometer.hpp"
#include "tests/unit/analysis/interferometer/whole_chain.hpp"

namespace dyncal::analysis {
namespace {

using simulated::Detectors;
using simulated::Motion;
using simulated::Signals;
using simulated::simulate;

Expected<RecordEllipse> own_ellipse(const Signals& signals) {
  return ellipse_of_record(std::span(signals.u1), std::span(signals.u2));
}

// A motion of the phase by +-`arc_rad`, and a drift by `turns` within the record.
Motion motion_of(double arc_rad, double turns) {
  Motion motion;
  motion.frequency_hz = 5000.0;
  motion.sample_rate_hz = 1e6;
  motion.seconds = 0.02;
  const double w = 2.0 * std::numbers::pi * motion.frequency_hz;
  motion.acceleration_m_s2 = arc_rad * simulated::wavelength_m / (4.0 * std::numbers::pi) * w * w;
  motion.drift_m_s = turns * simulated::wavelength_m / 2.0 / motion.seconds;
  return motion;
}

std::array<double, ellipse_parameters> parameters(const Ellipse& e) {
  return {e.p, e.q, e.r, e.alpha_rad, e.radius};
}

// Of 40 draws: the scatter of each parameter over its standard uncertainty, and the mean error over
// that of the mean.
void expect_honest_covariance(const Motion& motion, EllipseMethod method) {
  constexpr int draws = 40;
  const Detectors detectors;
  const auto truth = parameters(detectors.ellipse);
  std::array<double, ellipse_parameters> squares{};
  std::array<double, ellipse_parameters> sums{};
  for (int draw = 0; draw < draws; ++draw) {
    const auto own = own_ellipse(simulate(motion, detectors, static_cast<std::uint64_t>(draw + 1)));
    ASSERT_TRUE(own) << own.error().message;
    ASSERT_EQ(own->fit.method, method);
    const auto values = parameters(own->fit.ellipse);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double z = (values[k] - truth[k]) / std::sqrt(own->fit.covariance[k][k]);
      squares[k] += z * z / draws;
      sums[k] += z / draws;
    }
  }
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_GT(std::sqrt(squares[k]), 0.7) << k;
    EXPECT_LT(std::sqrt(squares[k]), 1.4) << k;
    // Noise adds to the linear radius, which the phase does not depend on.
    if (method == EllipseMethod::adjusted || k + 1 < truth.size()) {
      EXPECT_LT(std::abs(sums[k]) * std::sqrt(draws), 4.0) << k;
    }
  }
}

TEST(EllipseFit, ScattersAsItsCovarianceSaysAboveOneTurn) {
  expect_honest_covariance(motion_of(6.0, 0.3), EllipseMethod::linear);
}

TEST(EllipseFit, ScattersAsItsCovarianceSaysOnHalfATurn) {
  expect_honest_covariance(motion_of(0.5, 0.5), EllipseMethod::adjusted);
}

TEST(EllipseFit, AdjustmentRemovesTheBiasOfShortArcs) {
  double linear = 0.0;
  double adjusted = 0.0;
  constexpr int draws = 20;
  Detectors noisy;
  noisy.noise_rel = 8e-3;
  for (int draw = 0; draw < draws; ++draw) {
    const Signals signals =
        simulate(motion_of(1.0, 0.05), noisy, static_cast<std::uint64_t>(draw + 100));
    EllipseMoments moments;
    moments.add(std::span(signals.u1), std::span(signals.u2));
    const auto first = fit_ellipse_by(EllipseMethod::linear, moments);
    const auto second = fit_ellipse_by(EllipseMethod::adjusted, moments);
    ASSERT_TRUE(first && second);
    linear += (first->ellipse.radius / Detectors{}.ellipse.radius - 1.0) / draws;
    adjusted += (second->ellipse.radius / Detectors{}.ellipse.radius - 1.0) / draws;
  }
  EXPECT_LT(std::abs(adjusted), 0.25 * std::abs(linear)) << adjusted << " " << linear;
}

void expect_refused(const Expected<RecordEllipse>& ellipse, const std::string& word) {
  ASSERT_FALSE(ellipse);
  EXPECT_NE(ellipse.error().message.find(word), std::string::npos) << ellipse.error().message;
}

TEST(EllipseFit, ShortArcsAreSentToAnotherEllipse) {
  for (const double arc : {0.02, 0.05, 0.1, 0.25, 0.5, 0.9}) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const auto ellipse = own_ellipse(simulate(motion_of(arc, 0.0), {}, seed));
      expect_refused(ellipse, "another step");
    }
  }
}

TEST(EllipseFit, StandstillAndWhatIsNoEllipseAreRefused) {
  expect_refused(own_ellipse(simulate(motion_of(0.0, 0.0), {}, 7)), "another step");
  Signals line = simulate(motion_of(6.0, 0.0), {}, 8);
  line.u2 = line.u1; // both cables at one photodiode
  EXPECT_FALSE(own_ellipse(line));
  Signals silent = simulate(motion_of(6.0, 0.0), {}, 9);
  silent.u2.assign(silent.u2.size(), 12);
  expect_refused(own_ellipse(silent), "u2");
  Signals few = simulate(motion_of(6.0, 0.0), {}, 10);
  few.u1.resize(5);
  few.u2.resize(5);
  expect_refused(own_ellipse(few), "too few");
}

TEST(EllipseFit, SignalsThatAreNotFiniteAreRefused) {
  std::vector<double> u1;
  std::vector<double> u2;
  for (int i = 0; i < 1000; ++i) {
    u1.push_back(std::cos(0.1 * i));
    u2.push_back(i == 500 ? std::nan("") : std::sin(0.1 * i));
  }
  const auto ellipse = ellipse_of_record(std::span<const double>(u1), std::span<const double>(u2));
  ASSERT_FALSE(ellipse);
  EXPECT_EQ(ellipse.error().code, ErrorCode::not_finite) << ellipse.error().message;
}

} // namespace
} // namespace dyncal::analysis
