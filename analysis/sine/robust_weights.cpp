#include "analysis/sine/robust_weights.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr double huber_limit = 1.345;
constexpr double tukey_limit = 4.685;

} // namespace

double robust_weight(Weighting weighting, double residual, double scale) {
  const double x = std::abs(residual) / scale;
  switch (weighting) {
  case Weighting::none:
    return 1.0;
  case Weighting::huber:
    return x <= huber_limit ? 1.0 : huber_limit / x;
  case Weighting::tukey:
    break;
  }
  const double z = x / tukey_limit;
  return z < 1.0 ? (1.0 - z * z) * (1.0 - z * z) : 0.0;
}

double robust_slope(Weighting weighting, double residual, double scale) {
  const double x = std::abs(residual) / scale;
  switch (weighting) {
  case Weighting::none:
    return 1.0;
  case Weighting::huber:
    return x <= huber_limit ? 1.0 : 0.0;
  case Weighting::tukey:
    break;
  }
  const double z = x / tukey_limit;
  return z < 1.0 ? (1.0 - z * z) * (1.0 - 5.0 * z * z) : 0.0;
}

double robust_scale(std::span<double> absolute_residuals) {
  return mad_to_sd * upper_median(absolute_residuals);
}

} // namespace dyncal::analysis
