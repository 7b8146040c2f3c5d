#include "analysis/interferometer/ellipse_moments.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/analysis/interferometer/simulated_interferometer.hpp"

namespace dyncal::analysis {
namespace {

using simulated::Signals;
using simulated::simulate;

template <class Container>
auto part(const Container& values, std::size_t begin, std::size_t end) {
  return std::span(values).subspan(begin, end - begin);
}

void expect_near_means(const QuadratureMeans& a, const QuadratureMeans& b, double tolerance) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; i + j < a.size(); ++j) {
      EXPECT_NEAR(a[i][j], b[i][j], tolerance) << i << j;
    }
  }
}

TEST(EllipseMoments, AreThoseOfTheDefinition) {
  const Signals signals = simulate({}, {}, 1);
  EllipseMoments moments;
  moments.add(std::span(signals.u1), std::span(signals.u2));
  ASSERT_EQ(moments.samples(), 100000u);
  const SignalScale scale_1{100.0, 5000.0};
  const SignalScale scale_2{-300.0, 7000.0};
  const QuadratureMeans means = moments.means(scale_1, scale_2);
  QuadratureMeans expected{};
  for (std::size_t n = 0; n < signals.u1.size(); ++n) {
    const double x = (signals.u1[n] - scale_1.centre) / scale_1.scale;
    const double y = (signals.u2[n] - scale_2.centre) / scale_2.scale;
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t j = 0; i + j < 5; ++j) {
        expected[i][j] +=
            std::pow(x, static_cast<double>(i)) * std::pow(y, static_cast<double>(j)) / 100000.0;
      }
    }
  }
  expect_near_means(means, expected, 1e-11);
}

TEST(EllipseMoments, OfBlocksAndStepsAddUp) {
  const Signals signals = simulate({}, {}, 2);
  simulated::Motion short_arc;
  short_arc.acceleration_m_s2 = 0.01;
  const Signals other = simulate(short_arc, {}, 3);
  EllipseMoments together;
  together.add(std::span(signals.u1), std::span(signals.u2));
  together.add(std::span(other.u1), std::span(other.u2));
  EllipseMoments first;
  first.add(part(signals.u1, 0, 33333), part(signals.u2, 0, 33333));
  first.add(part(signals.u1, 33333, 100000), part(signals.u2, 33333, 100000));
  EllipseMoments second;
  second.add(std::span(other.u1), std::span(other.u2)); // in a scale of its own
  EllipseMoments sum;
  sum.add(second);
  sum.add(first);
  ASSERT_EQ(sum.samples(), together.samples());
  EXPECT_EQ(sum.range_1().low, together.range_1().low);
  EXPECT_EQ(sum.range_2().high, together.range_2().high);
  const SignalScale scale{0.0, 6500.0};
  expect_near_means(sum.means(scale, scale), together.means(scale, scale), 1e-12);
  EXPECT_NEAR(sum.difference_variance_1() / together.difference_variance_1(), 1.0, 1e-3);
}

TEST(EllipseMoments, TheNumberTypeOfTheSamplesMakesNoDifference) {
  const Signals signals = simulate({}, {}, 4);
  const std::vector<double> u1(signals.u1.begin(), signals.u1.end());
  const std::vector<double> u2(signals.u2.begin(), signals.u2.end());
  const std::vector<float> f1(u1.begin(), u1.end());
  const std::vector<float> f2(u2.begin(), u2.end());
  EllipseMoments of_int16;
  EllipseMoments of_double;
  EllipseMoments of_float;
  of_int16.add(std::span(signals.u1), std::span(signals.u2));
  of_double.add(std::span(u1), std::span(u2));
  of_float.add(std::span(f1), std::span(f2));
  ASSERT_GT(of_int16.own_scale_1().scale, 1000.0);
  EXPECT_EQ(of_int16.means({}, {}), of_double.means({}, {}));
  EXPECT_EQ(of_int16.means({}, {}), of_float.means({}, {}));
}

TEST(EllipseMoments, FourthDifferencesShowWhiteNoiseOfSlowFringes) {
  simulated::Motion slow;
  slow.acceleration_m_s2 = 0.1;
  simulated::Detectors detectors;
  detectors.noise_rel = 2e-3;
  const Signals signals = simulate(slow, detectors, 5);
  EllipseMoments moments;
  moments.add(std::span(signals.u1), std::span(signals.u2));
  const double noise = detectors.noise_rel * detectors.ellipse.radius;
  EXPECT_NEAR(std::sqrt(moments.difference_variance_1()) / noise, 1.0, 0.02);
  EXPECT_NEAR(std::sqrt(moments.difference_variance_2()) / noise, 1.0, 0.02);
}

} // namespace
} // namespace dyncal::analysis
