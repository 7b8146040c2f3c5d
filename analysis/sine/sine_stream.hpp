// Sine approximation while the samples arrive: the result is ready when the last sample is. No
// program uses it yet.
//
// Samples are reduced in blocks of 64, counted from the first; the sums of each block and their
// series in the frequency (frequency_series.hpp) are kept, the samples are not. Every bit of a
// result depends on the samples alone and not on how they came in pushes. Model, sign, units and
// failures are those of sine_fit.hpp; all channels share the stamps. Inside, phases refer to the
// first stamp; results to the caller's phase origin.
//
// fit() evaluates at the frequency given at the start, from running sums: well under a microsecond
// after the push of the last sample. fit_with_frequency() refines the frequency, shared by all
// channels, on the kept series: exact while it is within about 0.1 turns per block half length of
// the start, which is checked (not_converged names it). Its residual sum of squares keeps 16 digits
// of the squared amplitude, not of the noise.
//
// Memory: about 600 bytes a block and 250 a block and channel. A record spans at most 13 days. One
// thread at a time; no locks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

class SineStream {
public:
  // REQUIRES: channels > 0.
  SineStream(const Frequency& frequency, std::size_t channels);
  SineStream(SineStream&&) noexcept;
  SineStream& operator=(SineStream&&) noexcept;
  ~SineStream();

  // Another stream in the same state, to try how it would go on.
  [[nodiscard]] SineStream clone() const;

  // Appends samples; every channel as many values as there are stamps. After a failure
  // (stamps_not_increasing, not_finite, invalid_argument) nothing of this call counts and the
  // stream is as before.
  [[nodiscard]] Expected<void> push(std::span<const std::int64_t> stamps_ns,
                                    std::span<const std::span<const double>> channels);

  [[nodiscard]] std::uint64_t samples() const;

  // The fit of everything pushed so far, at the frequency of the start; more may be pushed
  // afterwards.
  [[nodiscard]] Expected<std::vector<SineFit>> fit(std::int64_t phase_origin_ns) const;

  // The same with the frequency refined within start * (1 +- search_rel).
  [[nodiscard]] Expected<FrequencyFit> fit_with_frequency(double search_rel,
                                                          std::int64_t phase_origin_ns) const;

private:
  class State;
  explicit SineStream(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

} // namespace dyncal::analysis
