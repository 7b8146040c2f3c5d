// How the least-squares problem of a record changes with the frequency, without returning to the
// samples.
//
// For the expansion frequency w0, with x_i = exp(-i w0 t_i) and u_i the time in units of a common
// scale, a segment keeps, for m = 0..6,
//
//   U_m = sum v^m,   X_m = sum v^m x,   Q_m = sum v^m x^2,   E_m = sum e v^m x,   v = u - centre
//
// e is the residual of start parameters p0 at w0. At w0 + delta / scale every sum of the sine
// approximation follows from the power series of exp(-i delta v); truncation is below (2 |delta|
// h)^7 / 5040 of the amplitude, h the half length of the longest segment. Differences against p0
// are formed term by term, so nothing cancels when delta is small.
//
// Model, sign and units are those of sine_fit.hpp. No allocation but the vectors; any thread.
#pragma once

#include <array>
#include <complex>
#include <span>
#include <vector>

#include "analysis/sine/kernel/sine_kernel.hpp"
#include "analysis/sine/sine_solve.hpp"

namespace dyncal::analysis::kernel {

using PowerSeries = std::array<std::complex<double>, moment_count>;

struct DesignFrequencySeries {
  double centre = 0.0;
  std::array<double, moment_count> u{};
  PowerSeries x{};
  PowerSeries xx{};
};

struct ResidualFrequencySeries {
  double e = 0.0;
  double ee = 0.0;
  PowerSeries ex{};
};

[[nodiscard]] DesignFrequencySeries design_frequency_series(const DesignMoments& moments,
                                                            double centre);
[[nodiscard]] ResidualFrequencySeries residual_frequency_series(const ResidualMoments& moments);

// What one segment holds: its design and one residual series a channel.
struct Segment {
  const DesignFrequencySeries* design;
  const ResidualFrequencySeries* channels; // as many as there are start values
};

// All sums at w0 + delta/scale, residuals against the same p0.
struct ShiftedSums {
  double n = 0.0;
  DesignSums design{};
  SlopeSums slope{};
  std::vector<ResidualSums> residuals;
  std::vector<ResidualSlopeSums> residual_slopes;
};
void shift_sums(std::span<const Segment> segments, std::span<const Parameters> start, double delta,
                ShiftedSums& result);

// Derivative of the model of one channel by delta, with the linear parameters eliminated.
struct SlopeProfile {
  double gradient = 0.0; // residual times derivative
  double curvature =
      0.0;             // square of what is left of the derivative beside sine, cosine and constant
  double whole = 0.0;  // square of the derivative itself
  Parameters coupling; // how (A, B, C) of the least-squares solution move per unit of delta
};
[[nodiscard]] SlopeProfile profile_slope(const ShiftedSums& sums, const NormalMatrix& matrix,
                                         const Solution& solution, std::size_t channel);

// The frequency shift that is most likely for all channels together: minimum of sum n log(rss_j),
// every channel with its own noise. Starts at `delta`, stays within +-limit, stops on steps below
// `settled`.
struct FrequencySolution {
  double delta = 0.0;
  double last_step = 0.0;
  bool settled = false; // the last step was below `settled`
  double u_delta = 0.0;
  NormalMatrix matrix{1.0, {}};
  std::vector<Solution> channels;
  std::vector<SlopeProfile> slopes;
};
[[nodiscard]] FrequencySolution solve_frequency(std::span<const Segment> segments,
                                                std::span<const Parameters> start, double delta,
                                                double limit, double settled = 1e-13);

// One channel's fit at the solution, phases about an instant `turns` and `shift` (in the scale of
// u) after the expansion's origin; the covariance includes that the frequency was estimated.
// REQUIRES: one variance degree of freedom at least.
[[nodiscard]] SineFit channel_fit(const FrequencySolution& solution, std::size_t channel,
                                  double shift, double turns);

} // namespace dyncal::analysis::kernel
