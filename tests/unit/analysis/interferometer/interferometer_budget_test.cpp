#include "analysis/interferometer/interferometer_budget.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

// Largest relative change of amplitude over the working points, and largest change of phase, of a
// sine of phase whose ellipse has been left uncorrected.
struct Change {
  double magnitude = 0.0;
  double phase_rad = 0.0;
};

Change simulated_change(const Ellipse& ellipse, double phase_amplitude_rad) {
  constexpr int samples = 4000;
  constexpr int points = 32;
  Change worst;
  for (int point = 0; point < points; ++point) {
    std::complex<double> sum;
    for (int i = 0; i < samples; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / samples;
      const double start = 2.0 * std::numbers::pi * point / points;
      const double phi = start + phase_amplitude_rad * std::sin(angle);
      const double x = ellipse.p + std::cos(phi);
      const double y = ellipse.q + std::sin(phi - ellipse.alpha_rad) / ellipse.r;
      const double error = std::remainder(std::atan2(y, x) - phi, 2.0 * std::numbers::pi);
      sum += error * std::complex<double>(std::sin(angle), std::cos(angle)) * 2.0 /
             static_cast<double>(samples) / phase_amplitude_rad;
    }
    worst.magnitude = std::max(worst.magnitude, std::abs(sum.real()));
    worst.phase_rad = std::max(worst.phase_rad, std::abs(sum.imag()));
  }
  return worst;
}

void expect_formula(const Ellipse& ellipse, double error_rad, int order, double m) {
  const double expected = largest_periodic_change(error_rad, order, m);
  const Change change = simulated_change(ellipse, m);
  EXPECT_NEAR(change.magnitude / expected, 1.0, 0.12) << order << " " << m;
  EXPECT_LT(change.phase_rad, 1e-9);
}

TEST(InterferometerBudget, PeriodicErrorsAreThoseOfASimulation) {
  for (const double m : {0.5, 2.0, 20.0}) {
    expect_formula({0.03, 0.0, 1.0, 0.0, 1.0}, 0.03, 1, m);
    expect_formula({0.0, 0.0, 1.05, 0.0, 1.0}, 0.025, 2, m);
    expect_formula({0.0, 0.0, 1.0, 0.0873, 1.0}, 0.0873 / 2.0, 2, m);
  }
}

RecordEllipse ellipse_with_fourth_harmonic() {
  RecordEllipse ellipse;
  ellipse.fit.ellipse.radius = 500.0;
  ellipse.fit.covariance[0][0] = 0.25; // 1e-3 of the radius
  ellipse.radius = RadiusHarmonics{500.0, {0.0, 0.0, 0.0, 3.65}};
  return ellipse;
}

InterferometerErrors errors_with_fourth_harmonic() {
  const auto errors = interferometer_errors(ellipse_with_fourth_harmonic(), -316.4e-9,
                                            {632.8e-9, 8e-6}, {1e6, 1e-8});
  EXPECT_TRUE(errors);
  return errors.value_or(InterferometerErrors{});
}

const Contribution& row(const std::vector<Contribution>& rows, ContributionKind kind) {
  return *std::ranges::find(rows, kind, &Contribution::kind);
}

TEST(InterferometerBudget, HasARowForEachInfluence) {
  const double one_radian_m = 316.4e-9 / (2.0 * std::numbers::pi);
  const auto rows =
      interferometer_rows({160.0, one_radian_m, 100.0}, errors_with_fourth_harmonic());
  ASSERT_EQ(rows.size(), 5u);
  // J1(1) = 0.44005, |J1(4)| = 0.06604
  EXPECT_NEAR(row(rows, ContributionKind::interferometer_ellipse).u_magnitude_rel,
              1e-3 * 2.0 * 0.44005 / std::sqrt(2.0), 1e-8);
  const Contribution& periodic = row(rows, ContributionKind::periodic_error);
  const double expected = 0.0073 * 2.0 * 0.06604 / std::sqrt(2.0);
  EXPECT_NEAR(periodic.u_magnitude_rel, expected, 1e-7);
  EXPECT_NEAR(periodic.u_phase_rad, expected / (100.0 * std::numbers::pi), 1e-9);
  EXPECT_EQ(row(rows, ContributionKind::wavelength).u_magnitude_rel, 8e-6);
  EXPECT_NEAR(row(rows, ContributionKind::detector_bandwidth).u_phase_rad, 1.6e-4 / std::sqrt(3.0),
              1e-12);
  EXPECT_NEAR(row(rows, ContributionKind::detector_skew).u_phase_rad,
              2.0 * std::numbers::pi * 160.0 * 1e-8, 1e-12);
}

TEST(InterferometerBudget, ManyFringesSeeHalfTheSkew) {
  const auto rows = interferometer_rows({160.0, 1e-5, 100.0}, errors_with_fourth_harmonic());
  EXPECT_NEAR(row(rows, ContributionKind::detector_skew).u_phase_rad,
              2.0 * std::numbers::pi * 160.0 * 1e-8 / 2.0, 1e-12);
}

TEST(InterferometerBudget, TellsTwoEllipsesApart) {
  const Ellipse one{0.02, -0.01, 1.05, 0.08, 0.6};
  Ellipse other = one;
  EXPECT_EQ(ellipse_difference(one, other), (EllipseErrors{0.0, 0.0}));
  other.p += 0.006;
  EXPECT_NEAR(ellipse_difference(one, other)[0], 0.01, 1e-12);
  other = one;
  other.alpha_rad += 0.02;
  EXPECT_NEAR(ellipse_difference(one, other)[1], 0.01, 1e-12);
}

TEST(InterferometerBudget, RefusesAnEllipseThatDoesNotShowThePeriodicError) {
  RecordEllipse ellipse = ellipse_with_fourth_harmonic();
  ellipse.radius.reset();
  const auto errors = interferometer_errors(ellipse, 316.4e-9, {632.8e-9, 8e-6}, {});
  ASSERT_FALSE(errors);
  EXPECT_EQ(errors.error().code, ErrorCode::ill_conditioned);
}

} // namespace
} // namespace dyncal::analysis
