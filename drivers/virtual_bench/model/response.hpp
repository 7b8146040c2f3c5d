// The true transfer function of one axis of a sensor: magnitude over frequency, and
//
//   phase = -2 pi f delay + residual phase
//
// in radians, lead positive, so that a delay is negative. Between the points of the table magnitude
// and residual phase follow a monotone cubic (Fritsch and Butland 1984, "PCHIP"); below the first
// point they stay constant, above the last one the magnitude falls with 1/f^2 as a low pass of
// second order does. Immutable; any thread.
#pragma once

#include <complex>
#include <vector>

namespace dyncal::drivers::virtual_bench {

class PchipTable {
public:
  PchipTable() = default;
  // REQUIRES: x rises, as many y as x, at least two.
  PchipTable(std::vector<double> x, std::vector<double> y);
  [[nodiscard]] double at(double x) const; // constant outside the table
  [[nodiscard]] double last_x() const { return x_.back(); }

private:
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> slope_;
};

struct AxisResponse {
  double gain = 1.0; // multiplies the table; negative: the axis points the other way
  double delay_s = 0.0;
  PchipTable magnitude;          // over Hz
  PchipTable residual_phase_rad; // over Hz

  [[nodiscard]] double magnitude_at(double frequency_hz) const; // with the sign of the gain
  [[nodiscard]] double residual_phase_at(double frequency_hz) const {
    return residual_phase_rad.at(frequency_hz);
  }
  [[nodiscard]] std::complex<double> at(double frequency_hz) const; // with the delay
};

} // namespace dyncal::drivers::virtual_bench
