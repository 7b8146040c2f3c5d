#include "analysis/sine/robust_weights.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {
namespace {

constexpr double huber_limit = 1.345;
constexpr double tukey_limit = 4.685;
constexpr double median_to_sd = 1.4826;

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
  const auto middle =
      absolute_residuals.begin() + static_cast<std::ptrdiff_t>(absolute_residuals.size() / 2);
  std::nth_element(absolute_residuals.begin(), middle, absolute_residuals.end());
  return median_to_sd * *middle;
}

} // namespace dyncal::analysis
