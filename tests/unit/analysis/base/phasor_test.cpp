#include "analysis/base/phasor.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

TEST(Phasor, WrapsAnyAngleIntoOneTurn) {
  EXPECT_DOUBLE_EQ(wrap_phase(pi), pi);
  EXPECT_DOUBLE_EQ(wrap_phase(-pi), pi);
  EXPECT_DOUBLE_EQ(wrap_phase(0.25 - 8.0 * pi), 0.25);
  EXPECT_DOUBLE_EQ(wrap_phase(3.0), 3.0);
}

TEST(Phasor, NothingHasUnitMagnitudeAndNoPhase) {
  EXPECT_EQ(unit_phasor({0.0, 0.0}), std::complex<double>(1.0, 0.0));
}

TEST(Phasor, PhaseOfNoiseIsAnywhere) {
  EXPECT_NEAR(phase_standard_uncertainty(0.0), pi / std::sqrt(3.0), 1e-9);
}

TEST(Phasor, PhaseOfAStrongSignalIsTheNoiseOverIt) {
  EXPECT_DOUBLE_EQ(phase_standard_uncertainty(200.0), 0.005);
  EXPECT_NEAR(phase_standard_uncertainty(9.999), 0.1,
              0.002); // no step worth speaking of where the forms meet
}

TEST(Phasor, UncertaintyOfAWeakPhaseIsTheScatterOfTheBivariateNormal) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  for (const double distance : {0.5, 1.5, 3.0}) {
    double sum = 0.0;
    constexpr int trials = 200000;
    for (int i = 0; i < trials; ++i) {
      const double angle = std::atan2(noise(random), distance + noise(random));
      sum += angle * angle;
    }
    EXPECT_NEAR(phase_standard_uncertainty(std::sqrt(distance * distance + 2.0)),
                std::sqrt(sum / trials), 0.01)
        << distance;
  }
}

} // namespace
} // namespace dyncal::analysis
