// A source's clock against the waveform of a multi-sine that it recorded, and the clocks of two
// sources against each other, by all lines together.
//
// The waveform has lines of known frequencies f_k: whatever else a record shows of the time between
// them is its clock. In blocks of the record, each long enough to tell the lines apart, all lines
// are fitted together; their phases against the mean of the record are one delay,
//
//   delta_b = sum_k w_k g_k arg(P_kb conj(P_k)) / sum_k w_k^2 g_k,   g_k = |P_kb|^2 / u_kb^2
//
// and delta over the blocks is the rate of the clock and its drift: a polynomial of the lowest
// order, 1 to 3, that describes it (chi squared). `in_waveform_time` takes it out of the stamps, so
// that the lines have their nominal frequencies in every record. The middle stays where it is.
//
// Two records of one waveform then differ by one time tau, modulo the period T of the waveform:
//
//   d_k = arg(P_k of the second conj(P_k of the first)) + lag_k = w_k tau
//
// with the phase lag of the second's converter taken out. tau is searched over T, then found by
// weighted least squares; where another tau within T describes the phases as well (chi squared
// less than 25 above), the lines are too few or too noisy. The u of tau is that of the noise of all
// lines; where these disagree by more than chance, of that, as if all were the same way round.
// Phases that are 0.2 rad off are refused, for no converter's response is.
//
// Times in s, stamps int64 ns. Fails as separated_lines.hpp and sine_fit.hpp do; no_excitation
// where no line shows, not_converged where the two records do not show one waveform. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/sine/separated_lines.hpp"

namespace dyncal::analysis {

struct WaveformClock {
  std::int64_t middle_ns = 0;
  double half_s = 0.0;
  std::vector<double> legendre_s; // of P_1, P_2, ... over the record: rate first
  double scatter_s = 0.0;         // standard deviation of the blocks' delays about these
  std::size_t blocks = 0;

  [[nodiscard]] double rate_rel() const; // by how much the lines come too fast in this clock
  [[nodiscard]] double u_rate_rel() const;
  [[nodiscard]] std::vector<std::int64_t>
  in_waveform_time(std::span<const std::int64_t> stamps_ns) const;
};

// By a channel that shows all lines well: sync. `search_rel`: how far off the rate may be.
[[nodiscard]] Expected<WaveformClock> find_waveform_clock(std::span<const Frequency> lines,
                                                          double search_rel,
                                                          std::span<const std::int64_t> stamps_ns,
                                                          std::span<const double> values);

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
