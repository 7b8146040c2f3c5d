// The uncertainty of a mean of repeated measurements whose noise is known but whose scatter from
// run to run is not (random effects).
//
//   y_fi = mu_f + b_fi + e_fi,   e_fi ~ N(0, u_fi^2) known,   b_fi ~ N(0, tau_f^2) unknown
//   Var(mean of y_fi) = (tau_f^2 + mean of u_fi^2) / n_f
//
// tau_f is integrated out by quadrature: its restricted likelihood (which of the n - 1 contrasts)
// times the prior 1 / (0.2 u + tau). Runs of the same session share what makes them scatter, so the
// other frequencies are evidence too: tau is taken as the same part of the noise, the same size or
// the same time (tau f) at all of them, each with the weight its likelihood gives it, and alike
// within 30 %. One frequency in ten may be unlike the others. Where none was repeated, nothing is
// known of tau, and u holds what the single run shows.
//
// Why so: with equal noise, Birge, Mandel and Paule, DerSimonian and Laird all take max(s, u),
// which covers 70 % (n = 2) and 82 % (n = 3) of large scatter; Hartung and Knapp's is Student's t
// of s, 4.7 u and 1.9 u wide at tau = 0. Of the priors, half-Cauchy and DuMouchel's cover 80..90 %
// at tau = 3 u and n = 2, the flat one is 1000 times too wide. For n = 2 alone, no rule covers
// every tau and is narrow at 0: this one covers 94 % and more, at 4.1 u (n = 2), 1.6 u (3), 1.2 u
// (5). With eight frequencies it covers 94..98 % at 1.17 u (n = 2), 1.10 u (3), 1.06 u (5) without
// scatter.
//
// Units: those of the values, the same at all frequencies. Any thread.
#pragma once

#include <span>
#include <vector>

#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::analysis {

struct RepeatedQuantity {         // at one frequency; both vectors of equal size
  std::vector<double> deviations; // of the single runs, from any common value
  std::vector<double> u;          // their noise
  double frequency_hz = 0.0;      // 0: not known
};

// What is known of the error of the plain mean: a mixture of normal distributions; or, where no
// noise is known, Student's t of the observed scatter.
struct MeanError {
  struct Part {
    double variance = 0.0;
    double weight = 0.0; // all parts: 1
  };
  std::vector<Part> parts;
  UncertaintyPart student{};
};

[[nodiscard]] std::vector<MeanError>
errors_of_means(std::span<const RepeatedQuantity> at_frequencies);

struct CombinedUncertainty {
  double u = 0.0;                                          // standard uncertainty, U / k
  double degrees_of_freedom = infinite_degrees_of_freedom; // nu_eff
  double k = 2.0;                                          // at 95.45 %

  [[nodiscard]] double expanded() const { return k * u; } // U
};

// With what all runs have in common, normal and known. U is half the 95.45 % interval; nu_eff is
// that of Student's t whose 68.27 % and 95.45 % intervals have the same quotient, k is its factor.
[[nodiscard]] CombinedUncertainty combine(const MeanError& error, double u_common);

} // namespace dyncal::analysis
