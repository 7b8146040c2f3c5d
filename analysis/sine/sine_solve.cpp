#include "analysis/sine/sine_solve.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/sine/kernel/sine_polynomial.hpp"

namespace dyncal::analysis::kernel {

NormalMatrix::NormalMatrix(double samples, const DesignSums& sums)
    : n(samples), s_mean(sums.s / samples), c_mean(sums.c / samples) {
  const double aa = sums.ss - sums.s * s_mean;
  const double ab = sums.sc - sums.s * c_mean;
  const double bb = (samples - sums.ss) - sums.c * c_mean;
  const double determinant = aa * bb - ab * ab;
  const double half_trace = 0.5 * (aa + bb);
  const double largest = half_trace + std::hypot(0.5 * (aa - bb), ab);
  smallest = determinant / largest / samples;
  if (!(smallest > 0.0)) {
    smallest = 0.0;
    return;
  }
  inverse_aa = bb / determinant;
  inverse_ab = -ab / determinant;
  inverse_bb = aa / determinant;
}

Solution solve(const NormalMatrix& matrix, const ResidualSums& sums, const Parameters& start) {
  const double u = sums.es - matrix.s_mean * sums.e;
  const double v = sums.ec - matrix.c_mean * sums.e;
  Solution result;
  result.step.sine = matrix.inverse_aa * u + matrix.inverse_ab * v;
  result.step.cosine = matrix.inverse_ab * u + matrix.inverse_bb * v;
  result.step.offset =
      sums.e / matrix.n - result.step.sine * matrix.s_mean - result.step.cosine * matrix.c_mean;
  result.p = {start.sine + result.step.sine, start.cosine + result.step.cosine,
              start.offset + result.step.offset};
  result.ee = sums.ee;
  result.rss = std::max(0.0, sums.ee - sums.e * (sums.e / matrix.n) - result.step.sine * u -
                                 result.step.cosine * v);
  if (!std::isfinite(sums.ee)) {
    result.rss = sums.ee;
  }
  return result;
}

std::array<double, 6> unit_covariance(const NormalMatrix& m) {
  const double ac = -(m.s_mean * m.inverse_aa + m.c_mean * m.inverse_ab);
  const double bc = -(m.s_mean * m.inverse_ab + m.c_mean * m.inverse_bb);
  const double cc = 1.0 / m.n - (m.s_mean * ac + m.c_mean * bc);
  return {m.inverse_aa, m.inverse_ab, ac, m.inverse_bb, bc, cc};
}

void rotate(SineFit& fit, double turns) {
  const auto [s, c] = sine_cosine_of_turns(turns);
  const double a = fit.sine;
  const double b = fit.cosine;
  fit.sine = a * c - b * s;
  fit.cosine = a * s + b * c;
  const auto [aa, ab, ac, bb, bc, cc] = fit.covariance;
  fit.covariance = {aa * c * c - 2.0 * ab * s * c + bb * s * s,
                    (aa - bb) * s * c + ab * (c * c - s * s),
                    ac * c - bc * s,
                    aa * s * s + 2.0 * ab * s * c + bb * c * c,
                    ac * s + bc * c,
                    cc};
}

SinCos sine_cosine_of_turns(double turns) {
  const double quarters = std::nearbyint(4.0 * turns);
  const double r = turns - 0.25 * quarters;
  const double z = r * r;
  double s = sine_coefficients[6];
  double c = cosine_coefficients[6];
  for (int i = 5; i >= 0; --i) {
    s = std::fma(s, z, sine_coefficients[i]);
    c = std::fma(c, z, cosine_coefficients[i]);
  }
  s *= r;
  c = std::fma(c, z, 1.0);
  switch (static_cast<int>(quarters) & 3) {
  case 0:
    return {s, c};
  case 1:
    return {c, -s};
  case 2:
    return {-s, -c};
  default:
    return {-c, s};
  }
}

bool is_significant(const SineFit& fit, double picked_from) {
  const double limit = std::sqrt(16.0 + 2.0 * std::log(picked_from));
  const double amplitude = fit.amplitude();
  // Rounding alone leaves about 1e-16 of the offset.
  return amplitude > limit * fit.u_amplitude() && amplitude > 1e-14 * std::abs(fit.offset);
}

} // namespace dyncal::analysis::kernel
