#include "drivers/virtual_bench/model/response.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

// Weighted harmonic mean of the neighbouring differences; 0 at a turning point, so the curve does
// not overshoot.
double inner_slope(double h0, double h1, double d0, double d1) {
  if (d0 * d1 <= 0.0) {
    return 0.0;
  }
  const double w0 = 2.0 * h1 + h0;
  const double w1 = h1 + 2.0 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

double end_slope(double h0, double h1, double d0, double d1) {
  const double slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0.0) {
    return 0.0;
  }
  return d0 * d1 <= 0.0 && std::abs(slope) > 3.0 * std::abs(d0) ? 3.0 * d0 : slope;
}

} // namespace

PchipTable::PchipTable(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)), slope_(x_.size()) {
  const std::size_t n = x_.size();
  std::vector<double> h(n - 1);
  std::vector<double> d(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = x_[i + 1] - x_[i];
    d[i] = (y_[i + 1] - y_[i]) / h[i];
  }
  if (n == 2) {
    slope_ = {d[0], d[0]};
    return;
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    slope_[i] = inner_slope(h[i - 1], h[i], d[i - 1], d[i]);
  }
  slope_[0] = end_slope(h[0], h[1], d[0], d[1]);
  slope_[n - 1] = end_slope(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
}

double PchipTable::at(double x) const {
  if (x_.empty()) {
    return 0.0;
  }
  if (x <= x_.front()) {
    return y_.front();
  }
  if (x >= x_.back()) {
    return y_.back();
  }
  const std::size_t i =
      static_cast<std::size_t>(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin()) - 1;
  const double h = x_[i + 1] - x_[i];
  const double s = (x - x_[i]) / h;
  const double r = 1.0 - s;
  return r * r * ((1.0 + 2.0 * s) * y_[i] + s * h * slope_[i]) +
         s * s * ((3.0 - 2.0 * s) * y_[i + 1] - r * h * slope_[i + 1]);
}

double AxisResponse::magnitude_at(double frequency_hz) const {
  const double last = magnitude.last_x();
  const double fall = frequency_hz > last ? (last / frequency_hz) * (last / frequency_hz) : 1.0;
  return gain * magnitude.at(frequency_hz) * fall;
}

std::complex<double> AxisResponse::at(double frequency_hz) const {
  const double turns = frequency_hz * delay_s;
  const double phase =
      -2.0 * std::numbers::pi * (turns - std::rint(turns)) + residual_phase_at(frequency_hz);
  return magnitude_at(frequency_hz) * std::polar(1.0, phase);
}

} // namespace dyncal::drivers::virtual_bench
