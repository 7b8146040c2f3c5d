// Sine approximation: paper eq. (1), ISO 16063-11 method 3, IEEE 1057 three- and four-parameter
// fits on irregular stamps.
//
//   y_j(t) = A_j sin(w (t - t_0)) + B_j cos(w (t - t_0)) + C_j
//   P = A + iB,   theta = atan2(B, A):   y = |P| sin(w (t - t_0) + theta) + C
//
// theta is lead in radians; the paper's lag is -theta. Stamps are int64 ns, strictly increasing,
// any spacing; t_0 is the caller's phase origin (the record's middle keeps w and theta
// uncorrelated). All channels of a call share stamps and thus the design; every channel is fitted
// on its own. Further columns: extended_sine_fit.hpp.
//
// Uncertainties come from the residuals: V = s^2 (D'D)^-1 with s^2 = rss / (n - p), white noise
// assumed; jitter and systematic parts have rows in the budget. A, B, C keep 14 digits of the
// amplitude, rss at least nine. Nearly equidistant records take a faster form, decided by the
// stamps alone. The same input gives the same bits.
//
// Fails: too_few_samples (n <= p), stamps_not_increasing, not_finite, frequency_out_of_range (more
// than half a turn per sample interval, unless these are so uneven that there is no alias),
// ill_conditioned, no_excitation (no channel has an amplitude of four standard uncertainties),
// not_converged, invalid_argument (sizes; a record of more than 26 days). No state; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct SineFit {
  double sine = 0.0;                  // A
  double cosine = 0.0;                // B
  double offset = 0.0;                // C
  std::array<double, 6> covariance{}; // of (A, B, C): AA, AB, AC, BB, BC, CC
  double rss = 0.0;                   // residual sum of squares
  std::uint64_t samples = 0;
  double degrees_of_freedom = 0.0;

  [[nodiscard]] double amplitude() const;
  [[nodiscard]] double phase_rad() const;
  [[nodiscard]] double u_amplitude() const;
  [[nodiscard]] double u_phase_rad() const;
  [[nodiscard]] double residual_sd() const; // s
};

// Known frequency (three parameters).
[[nodiscard]] Expected<std::vector<SineFit>>
fit_sine(const Frequency& frequency, std::int64_t phase_origin_ns,
         std::span<const std::int64_t> stamps_ns,
         std::span<const std::span<const double>> channels);

struct FrequencyFit {
  Frequency frequency;         // refined, shared by all channels
  double u_frequency_hz = 0.0; // for white noise; for any other: uncertainty/frequency_noise.hpp
  std::vector<SineFit>
      channels; // refitted at the final frequency; covariance includes that w was estimated
  int iterations = 0;
};

// Frequency estimated too (four parameters, one frequency shared by all channels). `start` may be
// wrong by many bins of 1/T: a coarse search over +-search_rel (relative, e.g. 5e-3) precedes the
// iteration, which stops on |dw| T < 1e-9. Each channel counts with its own noise: the frequency
// minimises sum over channels of log(rss).
[[nodiscard]] Expected<FrequencyFit>
fit_sine_and_frequency(const Frequency& start, double search_rel, std::int64_t phase_origin_ns,
                       std::span<const std::int64_t> stamps_ns,
                       std::span<const std::span<const double>> channels);

} // namespace dyncal::analysis
