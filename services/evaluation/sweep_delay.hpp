// The delay that a whole sweep over the frequencies has to itself, as where the trigger or the
// clock of a repetition is late: alike at all frequencies, it does not average over them in the
// group delay.
//
//   psi_rf - mean over r = c_r - 2 pi f d_r + e_rf      e_rf ~ N(0, u_rf^2) known
//
// d_r is fitted for each sweep r, beside a phase c_r of its own. Where the scatter of d_r is more
// than noise makes once in twenty times, the result is the uncertainty (from as many sweeps as
// there are: uncertainty/random_effects.hpp) of the mean of d_r, less what e_rf adds to it, which
// the regression of the group delay has already; else 0. Plain function, any thread.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::inline evaluation {

struct SweepPhase { // of one repetition at one frequency
  std::uint32_t sweep = 0;
  double frequency_hz = 0.0;
  double deviation_rad = 0.0; // from the mean of the repetitions
  double u_phase_rad = 0.0;   // noise
};

// In seconds.
[[nodiscard]] analysis::CombinedUncertainty u_delay_of_sweeps(std::span<const SweepPhase> phases);

} // namespace dyncal::inline evaluation
