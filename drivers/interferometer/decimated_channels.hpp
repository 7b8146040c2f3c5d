// Channels of one stream, all through the same low-pass filter to every D-th sample: numbers,
// stamps and flags of what is left.
//
// Sample k of the output is of the instant of sample k D of the input, whatever block or gap the
// stream began behind: the delay of the filter is taken off. Behind a gap the filter begins anew,
// so ten samples of the output are missing at either side of it. A NaN makes the outputs that it
// reaches NaN, no others. A clock that stays the same stays one, D times slower.
//
// The gain is 1 within 2e-7 up to 0.15 of the new rate (analysis/interferometer/
// decimation_filter.hpp). No synchronisation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "analysis/interferometer/decimation_filter.hpp"
#include "drivers/sample_block.hpp"

namespace dyncal::drivers::interferometer {

class DecimatedChannels {
public:
  // REQUIRES: a factor of 1 at least, channels.
  DecimatedChannels(std::size_t factor, std::size_t channels);

  // What comes next is not of the stream so far.
  void begin_again() { next_.reset(); }
  // `block`: numbers, stamps and flags; `columns`: its channels in their order. No samples where
  // the filter has not enough yet. Values of the block are not looked at.
  [[nodiscard]] SampleBlock push(const SampleBlock& block,
                                 std::span<const std::span<const double>> columns);
  // The samples of the block do not follow those before.
  [[nodiscard]] bool is_behind_gap(const SampleBlock& block) const {
    return next_ && *next_ != block.first_sample;
  }

private:
  struct Instant {
    std::int64_t stamp_ns = 0;
    std::uint32_t uncertainty_ns = 0;
    std::uint8_t flags = 0;
  };

  void begin_at(const SampleBlock& block);
  void note_instants(const SampleBlock& block);
  void add_instants(const SampleBlock& block, SampleBlock& output);

  std::size_t factor_;
  std::vector<analysis::DecimationFilter> filters_;
  std::vector<std::vector<double>> outputs_;
  std::optional<std::uint64_t> next_; // number of the input
  std::size_t skipped_ = 0;           // of it, before the filters begin
  std::uint64_t next_output_ = 0;
  std::uint64_t first_instant_ = 0; // number of the output
  std::deque<Instant> instants_;
  std::optional<RegularClock> clock_; // the same since it began
};

} // namespace dyncal::drivers::interferometer
