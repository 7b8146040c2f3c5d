// The clocks of two sources that recorded one multi-sine against each other, by all lines together.
//
// Two records of one waveform, each in the time of the waveform (waveform_clock.hpp), differ by one
// time tau, modulo the period T of the waveform:
//
//   d_k = arg(P_k of the second conj(P_k of the first)) + lag_k = w_k tau
//
// with the phase lag of the second's converter taken out. tau is searched over T, then found by
// weighted least squares; where another tau within T describes the phases as well (chi squared
// less than 25 above), the lines are too few or too noisy. The u of tau is that of the noise of all
// lines; where these disagree by more than chance, of that, as if all were the same way round.
// Phases that are 0.2 rad off are refused, for no converter's response is.
//
// Times in s. Fails: no_excitation where fewer than two lines show in both, not_converged where the
// two records do not show one waveform. Any thread.
#pragma once

#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/sine/separated_lines.hpp"

namespace dyncal::analysis {

struct LinkedLine {
  double deviation_rad = 0.0; // d_k - w_k tau
  double u_rad = 0.0;         // of d_k, white noise
};

struct WaveformLink {
  double offset_s = 0.0; // tau: the second's time at its middle, less the first's at its middle
  double u_offset_s = 0.0;
  double chi_squared = 0.0; // over its degrees of freedom
  std::vector<LinkedLine> lines;
};

// Of channel 0 in both; `lag_rad`: of the second's converter, a line each. REQUIRES: lines of the
// period.
[[nodiscard]] Expected<WaveformLink> link_waveforms(std::span<const Frequency> lines,
                                                    double period_s, const SeparatedLines& first,
                                                    const SeparatedLines& second,
                                                    std::span<const double> lag_rad);

} // namespace dyncal::analysis
