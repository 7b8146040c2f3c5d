// Sine approximation beside disturbances, and against outliers.
//
// Channel j, u = (t - t_m) / (T / 2) in [-1, 1], t_m the middle and T the length of the record:
//
//   y_j(t) = A sin(w (t - t_ref)) + B cos(w (t - t_ref)) + C
//          + sum_k d_k u^k                                    drift, k = 1..drift_order
//          + sum_h (A_h sin(h w (t - t_ref)) + B_h cos(...))  harmonics, h = 2..max_harmonic
//          + sum_l (A_l sin(w_l (t - t_ref)) + B_l cos(...))  lines: hum, neighbouring excitation
//          + u (A' sin(w (t - t_ref)) + B' cos(...))          drift of amplitude and phase
//
// C is the level in the middle of the record; so are A and B when the phasor drifts. Sign, phase
// and units are those of sine_fit.hpp; drift coefficients have the unit of the values. Solved by
// scaled normal equations with two steps of refinement on the residuals.
//
// Weights (iteratively reweighted least squares, robust_weights.hpp, scale re-estimated in every
// step) give the covariance s^2 (D'D)^-1 with Huber's correction, s^2 = sum psi^2 / (n - p) /
// mean(psi')^2. `rss` is that of the unweighted residuals.
//
// Fails as sine_fit.hpp does; invalid_argument (equal or non-positive lines), not_converged,
// ill_conditioned (reciprocal condition of the scaled matrix below 1e-10, e.g. drift powers in a
// small part of a period). Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/base/progress.hpp"
#include "analysis/sine/robust_weights.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

struct ExtendedBasis {
  int drift_order = 0;
  int max_harmonic = 1;
  std::vector<Frequency> lines;
  bool drifting_phasor = false;
};

struct FurtherPhasor { // a harmonic or a line, about the phase origin
  double frequency_hz = 0.0;
  double sine = 0.0;
  double cosine = 0.0;
  double u_sine = 0.0;
  double u_cosine = 0.0;
};

struct ExtendedFit {
  SineFit fundamental;       // covariance and degrees of freedom of the whole model
  std::vector<double> drift; // d_1, d_2, ...
  std::vector<double> u_drift;
  std::vector<FurtherPhasor> harmonics;
  std::vector<FurtherPhasor> lines;
  FurtherPhasor phasor_drift; // A', B' per half record; frequency 0 when not asked for
  std::uint64_t outliers = 0; // samples with less than half the weight
  int iterations = 0;         // of the weights
};

// `progress` counts what least squares takes; weights take more, in as many steps as they need.
[[nodiscard]] Expected<std::vector<ExtendedFit>>
fit_sine_extended(const Frequency& frequency, const ExtendedBasis& basis, Weighting weighting,
                  std::int64_t phase_origin_ns, std::span<const std::int64_t> stamps_ns,
                  std::span<const std::span<const double>> channels, const Progress& progress = {});

} // namespace dyncal::analysis
