// One pass over a record: blocks of samples go through the kernel, their sums are added up in
// order.
//
// The phase origin is the middle of the record, so that every time difference is exact and w and
// theta are uncorrelated; a fit is turned to the caller's phase origin afterwards. Fails as
// sine_fit.hpp does. No threads; does not own the samples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/sine/frequency_series.hpp"
#include "analysis/sine/kernel/sine_grid.hpp"
#include "analysis/sine/kernel/sine_kernel.hpp"

namespace dyncal::analysis::kernel {

using Channels = std::span<const std::span<const double>>;

class Record {
public:
  // Checks what needs no pass: sizes, the span of the stamps. `parameters`: how many a channel has.
  [[nodiscard]] static Expected<Record> make(std::span<const std::int64_t> stamps_ns,
                                             Channels channels, std::size_t parameters);

  [[nodiscard]] std::span<const std::int64_t> stamps() const { return stamps_; }
  [[nodiscard]] Channels channels() const { return channels_; }
  [[nodiscard]] std::size_t size() const { return stamps_.size(); }
  [[nodiscard]] std::int64_t origin_ns() const { return origin_ns_; }
  [[nodiscard]] double span_s() const { return span_s_; }
  [[nodiscard]] double half_span_ns() const { return span_s_ * 0.5e9; }

  // More than half a turn per sample interval cannot be told from its alias, unless the intervals
  // are so uneven that it has none.
  [[nodiscard]] Expected<void> check_nyquist(const Frequency& frequency) const;
  // Asks for the first samples, on their way while a fit is prepared.
  void fetch_beginning() const;
  [[nodiscard]] TimeAxis axis(const Frequency& frequency) const;

  // The errors of which only a pass tells that they are there; these find the place.
  [[nodiscard]] Error not_increasing() const;
  [[nodiscard]] Error not_finite() const;

private:
  Record(std::span<const std::int64_t> stamps, Channels channels);
  std::span<const std::int64_t> stamps_;
  Channels channels_;
  std::int64_t origin_ns_ = 0;
  double span_s_ = 0.0;
};

// Which samples a pass looks at: `length` of every `step`, from the first.
struct Selection {
  std::size_t length = block_samples;
  std::size_t step = block_samples;
};

struct PassSums {
  double samples = 0.0;
  DesignSums design{};
  std::vector<ResidualSums> channels;
};

// Sums about the start values. Fails: stamps_not_increasing.
[[nodiscard]] Expected<PassSums> accumulate(const Record& record, const Frequency& frequency,
                                            std::span<const Parameters> start,
                                            Selection selection = {});

// The same of samples copied out of the record, at most a block: `values` channel by channel.
[[nodiscard]] Expected<PassSums> accumulate(const Record& record, const Frequency& frequency,
                                            std::span<const Parameters> start,
                                            std::span<const std::int64_t> stamps,
                                            std::span<const double> values);

// The same of all samples, by the fast form where they are near the grid (sine_grid.hpp).
[[nodiscard]] Expected<PassSums> accumulate(const Record& record, const Frequency& frequency,
                                            std::span<const Parameters> start,
                                            const SampleGrid& grid);

[[nodiscard]] bool all_finite(const PassSums& sums);

// The same with the series of the whole record in the frequency (frequency_series.hpp, one segment,
// u in units of half the span). Design moments up to u^2 and residual moments up to u^1 are exact
// sums over the samples, higher ones follow from those of the blocks: they are wrong by the square
// (residuals) or cube (design) of `block_half_length` only.
struct FrequencySeriesSums {
  DesignFrequencySeries design;
  std::vector<ResidualFrequencySeries> channels;
  double block_half_length = 0.0;

  [[nodiscard]] Segment segment() const { return {&design, channels.data()}; }
};
[[nodiscard]] Expected<FrequencySeriesSums>
accumulate_frequency_series(const Record& record, const Frequency& frequency,
                            std::span<const Parameters> start, Selection selection = {});
[[nodiscard]] bool all_finite(const FrequencySeriesSums& sums);

} // namespace dyncal::analysis::kernel
