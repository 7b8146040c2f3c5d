// One transfer function value from repeated measurements at the same frequency.
//
//   |H|   = mean of |H_i|, less what noise adds to lengths (rice.hpp), where that is significant
//   psi   = arg sum(H_i / |H_i|)                                the circular mean
//   e_i   = |H_i| / |H| - 1  and  sin(psi_i - psi) / R          R = |sum(H_i / |H_i|)| / n
//
// but the angle itself beyond a quarter turn, where the sine falls again.
//
// So repetitions whose phase scatters, as shots of a sensor that runs free, keep their magnitude:
// the length of their mean phasor would be shorter by e^{-s^2 / 2}. Where their lengths do not
// stand out of what noise alone would give, the mean is that of the phasors. Only noise of the
// phasors themselves lengthens them (the rows "noise of"), not a bound of hum or of a stamp; what
// it adds is taken off from a tenth of its own uncertainty in the mean on: less is not known.
//
// u of a mean: random_effects.hpp. Every repetition states its own noise (u_random), known with
// many degrees of freedom; scatter beyond it is found from all repeated frequencies together, that
// of whole sweeps by their numbers. What is common to all repetitions (reference, ADC, delays) does
// not average. `u_magnitude` and `u_phase_rad` are U / 2, so that the factor 2 that every reader
// applies covers 95.45 % although n is small; u (k = 1), nu_eff and k are in `magnitude_rel` and
// `phase`. Where no frequency was repeated, they are those of the single result's own budget
// (coverage.hpp). A mean below 10 u has the phase uncertainty of phasor.hpp; none exceeds
// pi / sqrt(3), that of an angle of which nothing is known.
//
// Fails: invalid_argument (no repetition), not_finite. Any thread.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/uncertainty/contribution.hpp"
#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::analysis {

struct Repetition {
  std::complex<double> h;
  double u_random_magnitude_rel = 0.0; // independent from repetition to repetition
  double u_random_phase_rad = 0.0;
  double u_common_magnitude_rel = 0.0; // the same in all of them
  double u_common_phase_rad = 0.0;
  // Of all of it together: what a single repetition, which nothing is compared with, states.
  double freedom_magnitude = infinite_degrees_of_freedom;
  double freedom_phase = infinite_degrees_of_freedom;
  double u_not_noise_magnitude_rel = 0.0; // part of u_random that is no noise of the phasor
  std::uint32_t sweep = 0;                // which sweep over the frequencies it is of; 0: not known
};

// Divides a budget: rows that are drawn anew in every repetition are random, but for the part of
// the magnitude that lasts; the others are common to all repetitions (Contribution::repeats).
[[nodiscard]] Repetition make_repetition(std::complex<double> h,
                                         std::span<const Contribution> budget);

struct RepetitionMean {
  std::complex<double> h;
  double magnitude = 0.0;
  double u_magnitude = 0.0; // U / 2
  double phase_rad = 0.0;   // (-pi, pi]
  double u_phase_rad = 0.0; // U / 2
  double u_independent_phase_rad =
      0.0; // U / 2 without the common part: for the regression over frequency
  double scatter_magnitude = 0.0; // s of one repetition, in the unit of the magnitude; 0 for n = 1
  double scatter_phase_rad = 0.0;
  std::size_t repetitions = 0;
  bool polarity_differs = false; // of repetitions whose phase is known: one points the other way
  CombinedUncertainty magnitude_rel;
  CombinedUncertainty phase;
  CombinedUncertainty independent_magnitude_rel; // without the common part
  CombinedUncertainty independent_phase;
};

struct RepeatedFrequency {
  double frequency_hz = 0.0;
  std::vector<Repetition> repetitions;
};

// Of all frequencies of one channel that were measured in one session: together they say how much
// runs scatter, which two runs at one frequency cannot. One result for each, in their order.
[[nodiscard]] std::vector<Expected<RepetitionMean>>
means_of_repetitions(std::span<const RepeatedFrequency> frequencies);

// Of one frequency by itself.
[[nodiscard]] Expected<RepetitionMean> mean_of_repetitions(std::span<const Repetition> repetitions);

} // namespace dyncal::analysis
