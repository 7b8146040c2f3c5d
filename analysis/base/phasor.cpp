#include "analysis/base/phasor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::analysis {

std::complex<double> unit_phasor(std::complex<double> z) {
  const double magnitude = std::abs(z);
  return magnitude > 0.0 ? z / magnitude : std::complex<double>(1.0, 0.0);
}

double wrap_phase(double angle_rad) {
  constexpr double turn = 2.0 * std::numbers::pi;
  const double wrapped = std::remainder(angle_rad, turn);
  return wrapped <= -std::numbers::pi ? wrapped + turn : wrapped;
}

double phase_standard_uncertainty(double snr) {
  constexpr double pi = std::numbers::pi;
  if (snr >= 10.0) {
    return 1.0 / snr;
  }
  const double distance = std::sqrt(std::max(0.0, snr * snr - 2.0));
  // Density of the angle a: exp(-d^2/2)/(2 pi) + x Phi(x) exp(-d^2 sin^2(a)/2) / sqrt(2 pi), x = d
  // cos(a).
  const auto second_moment = [distance](double angle) {
    const double x = distance * std::cos(angle);
    const double y = distance * std::sin(angle);
    const double normal = 0.5 * std::erfc(-x / std::numbers::sqrt2);
    const double density = std::exp(-0.5 * distance * distance) / (2.0 * pi) +
                           x * normal * std::exp(-0.5 * y * y) / std::sqrt(2.0 * pi);
    return angle * angle * density;
  };
  constexpr int intervals = 200; // Simpson's rule over [0, pi], twice by symmetry
  const double step = pi / intervals;
  double sum = second_moment(0.0) + second_moment(pi);
  for (int i = 1; i < intervals; ++i) {
    sum += (i % 2 == 1 ? 4.0 : 2.0) * second_moment(step * i);
  }
  return std::sqrt(2.0 * sum * step / 3.0);
}

} // namespace dyncal::analysis
