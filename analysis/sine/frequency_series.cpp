#include "analysis/sine/frequency_series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyncal::analysis::kernel {
namespace {

using Complex = std::complex<double>;

// Plain products: std::complex's own would look for infinities.
Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// Coefficients of powers of v, with a = exp(-i delta u) over the segment.
struct Coefficients {
  PowerSeries shift;       // a
  PowerSeries square;      // a^2
  PowerSeries loss;        // 1 - a
  PowerSeries loss_times;  // a - a^2
  PowerSeries loss_square; // (1 - a)^2

  Coefficients(double delta, double centre) {
    const double angle = delta * centre;
    const double half = std::sin(0.5 * angle);
    const Complex rho = std::polar(1.0, -angle);
    const Complex one_less_rho{2.0 * half * half, std::sin(angle)};
    const Complex rho_square = times(rho, rho);
    Complex single = 1.0;
    Complex twice = 1.0;
    for (std::size_t m = 0; m < moment_count; ++m) {
      if (m > 0) {
        const double step = delta / static_cast<double>(m);
        single = times(single, {0.0, -step});
        twice = times(twice, {0.0, -2.0 * step});
      }
      shift[m] = times(rho, single);
      square[m] = times(rho_square, twice);
      loss[m] = m == 0 ? one_less_rho : -shift[m];
      loss_times[m] = m == 0 ? times(rho, one_less_rho) : shift[m] - square[m];
      loss_square[m] = m == 0 ? times(one_less_rho, one_less_rho) : square[m] - 2.0 * shift[m];
    }
  }
};

// Sum of coefficient times moment, the moments `raised` orders higher.
template <class Moments>
Complex dot(const PowerSeries& coefficients, const Moments& moments, std::size_t raised) {
  Complex sum = 0.0;
  for (std::size_t m = 0; m + raised < moment_count; ++m) {
    sum += times(coefficients[m], Complex(moments[m + raised]));
  }
  return sum;
}

// Weighted with u^0, u^1, u^2, u = centre + v.
template <class Moments>
std::array<Complex, 3> weighted(const PowerSeries& coefficients, const Moments& moments,
                                double centre) {
  const Complex zero = dot(coefficients, moments, 0);
  const Complex one = dot(coefficients, moments, 1);
  const Complex two = dot(coefficients, moments, 2);
  return {zero, centre * zero + one, centre * (centre * zero + 2.0 * one) + two};
}

void add_design(const DesignFrequencySeries& d, const Coefficients& k, ShiftedSums& result) {
  const double n = d.u[0];
  const double u = d.centre * n + d.u[1];
  const double uu = d.centre * (d.centre * n + 2.0 * d.u[1]) + d.u[2];
  const auto x = weighted(k.shift, d.x, d.centre);
  const auto xx = weighted(k.square, d.xx, d.centre);
  result.n += n;
  result.design.s -= x[0].imag();
  result.design.c += x[0].real();
  result.design.ss += 0.5 * (n - xx[0].real());
  result.design.sc -= 0.5 * xx[0].imag();
  SlopeSums& slope = result.slope;
  slope.u += u;
  slope.uu += uu;
  slope.us -= x[1].imag();
  slope.uc += x[1].real();
  slope.uss += 0.5 * (u - xx[1].real());
  slope.usc -= 0.5 * xx[1].imag();
  slope.uus -= x[2].imag();
  slope.uuc += x[2].real();
  slope.uuss += 0.5 * (uu - xx[2].real());
  slope.uusc -= 0.5 * xx[2].imag();
}

// What the change of the basis under fixed parameters adds to the residuals: p0's model at w0 less
// p0's model at the new frequency.
struct DesignChange {
  Complex constant;              // sum x (1 - a)
  std::array<Complex, 3> direct; // sum u^j (1 - a)
  std::array<Complex, 3> image;  // sum u^j x^2 (a - a^2)
  Complex image_square;          // sum x^2 (1 - a)^2

  DesignChange(const DesignFrequencySeries& d, const Coefficients& k)
      : constant(dot(k.loss, d.x, 0)), direct(weighted(k.loss, d.u, d.centre)),
        image(weighted(k.loss_times, d.xx, d.centre)), image_square(dot(k.loss_square, d.xx, 0)) {}

  // Sum of u^j (change) x_new.
  [[nodiscard]] Complex onto_basis(Complex p, std::size_t j) const {
    const Complex sum = times(p, direct[j]) + times(std::conj(p), image[j]);
    return {-0.5 * sum.imag(), 0.5 * sum.real()}; // times i/2
  }
  [[nodiscard]] double squared(Complex p) const {
    return std::norm(p) * direct[0].real() -
           0.5 * times(times(p, p), std::conj(image_square)).real();
  }
};

void add_residuals(const Segment& segment, const Coefficients& k, const DesignChange& change,
                   std::span<const Parameters> start, ShiftedSums& result) {
  for (std::size_t j = 0; j < start.size(); ++j) {
    const ResidualFrequencySeries& r = segment.channels[j];
    const Complex p{start[j].sine, start[j].cosine};
    const auto ex = weighted(k.shift, r.ex, segment.design->centre);
    const Complex onto = ex[0] + change.onto_basis(p, 0);
    const Complex slope = ex[1] + change.onto_basis(p, 1);
    const double cross = times(p, std::conj(dot(k.loss, r.ex, 0))).imag();
    ResidualSums& sums = result.residuals[j];
    sums.e += r.e + times(p, std::conj(change.constant)).imag();
    sums.es -= onto.imag();
    sums.ec += onto.real();
    sums.ee += r.ee + 2.0 * cross + change.squared(p);
    result.residual_slopes[j].eus -= slope.imag();
    result.residual_slopes[j].euc += slope.real();
  }
}

} // namespace

DesignFrequencySeries design_frequency_series(const DesignMoments& moments, double centre) {
  DesignFrequencySeries series;
  series.centre = centre;
  for (std::size_t m = 0; m < moment_count; ++m) {
    series.u[m] = moments.u[m];
    series.x[m] = {moments.uc[m], -moments.us[m]};
    series.xx[m] = {moments.u[m] - 2.0 * moments.uss[m], -2.0 * moments.usc[m]};
  }
  return series;
}

ResidualFrequencySeries residual_frequency_series(const ResidualMoments& moments) {
  ResidualFrequencySeries series;
  series.e = moments.e;
  series.ee = moments.ee;
  for (std::size_t m = 0; m < moment_count; ++m) {
    series.ex[m] = {moments.uc[m], -moments.us[m]};
  }
  return series;
}

void shift_sums(std::span<const Segment> segments, std::span<const Parameters> start, double delta,
                ShiftedSums& result) {
  result.n = 0.0;
  result.design = {};
  result.slope = {};
  result.residuals.assign(start.size(), {});
  result.residual_slopes.assign(start.size(), {});
  for (const Segment& segment : segments) {
    const Coefficients coefficients(delta, segment.design->centre);
    add_design(*segment.design, coefficients, result);
    add_residuals(segment, coefficients, DesignChange(*segment.design, coefficients), start,
                  result);
  }
}

SlopeProfile profile_slope(const ShiftedSums& sums, const NormalMatrix& m, const Solution& solution,
                           std::size_t channel) {
  const SlopeSums& k = sums.slope;
  const ResidualSlopeSums& r = sums.residual_slopes[channel];
  const Parameters& p = solution.p;
  const Parameters& d = solution.step;
  const double ucc = k.u - k.uss;
  const double uucc = k.uu - k.uuss;
  // The derivative is q = u (A c - B s); its products with the basis and with itself.
  const double with_one = p.sine * k.uc - p.cosine * k.us;
  const double with_sine = p.sine * k.usc - p.cosine * k.uss - with_one * m.s_mean;
  const double with_cosine = p.sine * ucc - p.cosine * k.usc - with_one * m.c_mean;
  const double residual_sine = r.eus - d.sine * k.uss - d.cosine * k.usc - d.offset * k.us;
  const double residual_cosine = r.euc - d.sine * k.usc - d.cosine * ucc - d.offset * k.uc;
  SlopeProfile profile;
  profile.gradient = p.sine * residual_cosine - p.cosine * residual_sine;
  profile.whole =
      p.sine * p.sine * uucc - 2.0 * p.sine * p.cosine * k.uusc + p.cosine * p.cosine * k.uuss;
  profile.coupling.sine = -(m.inverse_aa * with_sine + m.inverse_ab * with_cosine);
  profile.coupling.cosine = -(m.inverse_ab * with_sine + m.inverse_bb * with_cosine);
  profile.coupling.offset =
      -with_one / m.n - profile.coupling.sine * m.s_mean - profile.coupling.cosine * m.c_mean;
  profile.curvature = profile.whole - with_one * with_one / m.n +
                      profile.coupling.sine * with_sine + profile.coupling.cosine * with_cosine;
  return profile;
}

FrequencySolution solve_frequency(std::span<const Segment> segments,
                                  std::span<const Parameters> start, double delta, double limit,
                                  double settled) {
  constexpr int max_steps = 60;
  FrequencySolution result;
  ShiftedSums sums;
  result.delta = delta;
  for (int step = 0; step < max_steps; ++step) {
    shift_sums(segments, start, result.delta, sums);
    result.matrix = NormalMatrix(sums.n, sums.design);
    result.channels.clear();
    result.slopes.clear();
    double gradient = 0.0;
    double curvature = 0.0;
    for (std::size_t j = 0; j < start.size(); ++j) {
      result.channels.push_back(solve(result.matrix, sums.residuals[j], start[j]));
      const Solution& solution = result.channels.back();
      result.slopes.push_back(profile_slope(sums, result.matrix, solution, j));
      // A channel without noise still has that of its rounding.
      const double floor = 1e-32 * (std::norm(Complex(solution.p.sine, solution.p.cosine)) +
                                    solution.p.offset * solution.p.offset);
      const double variance =
          std::max(solution.rss / (sums.n - 3.0 - 1.0 / static_cast<double>(start.size())),
                   floor + std::numeric_limits<double>::min());
      gradient += result.slopes.back().gradient / variance;
      curvature += result.slopes.back().curvature / variance;
    }
    result.u_delta =
        curvature > 0.0 ? 1.0 / std::sqrt(curvature) : std::numeric_limits<double>::infinity();
    result.last_step = curvature > 0.0 ? gradient / curvature : 0.0;
    result.settled = std::abs(result.last_step) < settled;
    if (result.settled || !(curvature > 0.0)) {
      break;
    }
    const double next = std::clamp(result.delta + result.last_step, -limit, limit);
    if (next == result.delta) {
      break; // held at the limit
    }
    result.delta = next;
  }
  return result;
}

SineFit channel_fit(const FrequencySolution& all, std::size_t channel, double shift, double turns) {
  const Solution& solution = all.channels[channel];
  SineFit fit;
  fit.sine = solution.p.sine;
  fit.cosine = solution.p.cosine;
  fit.offset = solution.p.offset;
  fit.rss = solution.rss;
  fit.samples = static_cast<std::uint64_t>(all.matrix.n);
  fit.degrees_of_freedom = all.matrix.n - 3.0 - 1.0 / static_cast<double>(all.channels.size());
  fit.covariance = unit_covariance(all.matrix);
  for (double& element : fit.covariance) {
    element *= fit.rss / fit.degrees_of_freedom;
  }
  rotate(fit, turns);
  // The estimated frequency moves the parameters: by the coupling at the origin, and by the turn to
  // the reference.
  const auto [s, c] = sine_cosine_of_turns(turns);
  const Parameters& k = all.slopes[channel].coupling;
  const double along[3] = {k.sine * c - k.cosine * s - shift * fit.cosine,
                           k.sine * s + k.cosine * c + shift * fit.sine, k.offset};
  const double variance = all.u_delta * all.u_delta;
  std::size_t element = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      fit.covariance[element++] += along[row] * along[column] * variance;
    }
  }
  return fit;
}

} // namespace dyncal::analysis::kernel
