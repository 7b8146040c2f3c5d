// A source's clock against the waveform of a multi-sine that it recorded, by all lines together.
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
// Times in s, stamps int64 ns. Fails as separated_lines.hpp and sine_fit.hpp do; no_excitation
// where no line shows. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"

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

} // namespace dyncal::analysis
