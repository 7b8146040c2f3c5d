// The uncertainty of a mean of repeated measurements whose noise is known but whose scatter from
// run to run is not (random effects).
//
//   y_fi = mu_f + b_fi + e_fi,   e_fi ~ N(0, u_fi^2) known,   b_fi ~ N(0, tau_f^2) unknown
//   Var(mean of y_fi) = (tau_f^2 + mean of u_fi^2) / n_f
//
// tau_f is integrated out by quadrature: its restricted likelihood (which of the n - 1 contrasts)
// times a prior (scatter_grid.hpp). Runs of the same session share what makes them scatter, so the
// other frequencies are evidence too: tau is taken as the same part of the noise, the same size or
// the same time (tau f) at all of them, each with the weight its likelihood gives it, and alike
// within 30 %, or nothing scatters (35 %, from four frequencies on). One frequency in ten may be
// unlike the others. Or whole sweeps scatter, alike at all frequencies (sweep_scatter.hpp): then n
// sweeps tell it with n - 1 degrees of freedom. Where none was repeated, nothing is known of tau,
// and u holds what the single run shows.
//
// Why so: with equal noise, Birge, Mandel and Paule, DerSimonian and Laird all take max(s, u),
// which covers 70 % (n = 2) and 82 % (n = 3) of large scatter; Hartung and Knapp's is Student's t
// of s, 4.7 u and 1.9 u wide at tau = 0. Of the priors, half-Cauchy and DuMouchel's cover 80..90 %
// at tau = 3 u and n = 2, the flat one is 1000 times too wide. No rule covers every tau of one to
// three frequencies and is narrow at 0: this one covers 95.4 % of one frequency at worst (n = 3 and
// more, tau from 0 to 20 u, by quadrature), 95 % of several, of runs or of sweeps, at 5.6 u (one
// frequency, n = 2), 2.0 u (3), 1.4 u (5), within Student's factor. From four frequencies on it is
// 1.7 u without scatter (n = 2: one degree of freedom for sweeps), 1.1 u (3), 1.05 u (5).
//
// Units: those of the values, the same at all frequencies. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/uncertainty/mean_error.hpp"

namespace dyncal::analysis {

struct RepeatedQuantity {                   // at one frequency; both vectors of equal size
  std::vector<double> deviations;           // of the single runs, from any common value
  std::vector<double> u;                    // their noise
  double frequency_hz = 0.0;                // 0: not known
  std::vector<std::uint32_t> repetitions{}; // which each run is of; empty: 1, 2, 3 ...
};

[[nodiscard]] std::vector<MeanError>
errors_of_means(std::span<const RepeatedQuantity> at_frequencies);

} // namespace dyncal::analysis
