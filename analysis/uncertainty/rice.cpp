#include "analysis/uncertainty/rice.hpp"

#include <cmath>
#include <numbers>

namespace dyncal::analysis {
namespace {

constexpr double strong = 20.0; // amplitudes in standard deviations: the series has 8 digits there

} // namespace

double rice_mean(double amplitude, double sd) {
  if (!(sd > 0.0) || amplitude > 1e8 * sd) {
    return amplitude;
  }
  if (amplitude > strong * sd) {
    const double part = sd / amplitude;
    return amplitude * (1.0 + 0.5 * part * part * (1.0 + 0.25 * part * part));
  }
  const double half = 0.25 * amplitude * amplitude / (sd * sd);
  return sd * std::sqrt(0.5 * std::numbers::pi) * std::exp(-half) *
         ((1.0 + 2.0 * half) * std::cyl_bessel_i(0.0, half) +
          2.0 * half * std::cyl_bessel_i(1.0, half));
}

double rice_standard_deviation(double amplitude, double sd) {
  if (amplitude > strong * sd) {
    const double part = sd / amplitude;
    return sd * (1.0 - 0.25 * part * part);
  }
  const double mean = rice_mean(amplitude, sd);
  return std::sqrt(amplitude * amplitude + 2.0 * sd * sd - mean * mean);
}

double amplitude_of_rice_mean(double mean, double sd) {
  if (!(mean > rice_mean(0.0, sd))) {
    return 0.0;
  }
  double low = 0.0;
  double high = mean; // noise never shortens the mean
  for (int i = 0; i < 100 && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (rice_mean(middle, sd) > mean ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

} // namespace dyncal::analysis
