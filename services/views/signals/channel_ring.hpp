// The newest samples of one channel, and the smallest and largest of every millisecond of the last
// minute, in bounded memory (4 MB).
//
// Samples are pushed block by block with their stamps, in the time base of their source. NaN (not
// measured) is left out. A gap is where samples are missing or time jumps back; before the latter
// everything is forgotten. When samples came is kept too, block by block: what the bus announces
// has instants of this host, samples have stamps of their source. Plain data; one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "services/bus/clock.hpp"

namespace dyncal::inline views {

struct Sample {
  std::int64_t stamp_ns = 0;
  double value = 0.0;
};

struct Extremes { // of the samples that begin within a millisecond
  std::int64_t begin_ns = 0;
  double minimum = 0.0;
  double maximum = 0.0;
};

class ChannelRing {
public:
  using Instant = bus::Clock::Instant;

  static constexpr std::size_t max_samples = std::size_t{1} << 17U;
  static constexpr std::size_t max_extremes = 60'000;
  static constexpr std::size_t max_gaps = 100;
  static constexpr std::size_t max_arrivals = 4096;
  static constexpr std::int64_t extremes_ns = 1'000'000;

  // `missing`: samples are missing before these. `received_utc_ns`: of the block, by its host.
  // `came`: to this one.
  void push(std::span<const std::int64_t> stamps_ns, std::span<const double> values, bool missing,
            std::int64_t received_utc_ns, Instant came = {});
  void clear();

  [[nodiscard]] bool empty() const { return samples_.empty(); }
  [[nodiscard]] const std::deque<Sample>& samples() const { return samples_; }
  [[nodiscard]] const std::deque<Extremes>& extremes() const { return extremes_; }
  // Last stamp before and first after each.
  [[nodiscard]] const std::deque<std::pair<std::int64_t, std::int64_t>>& gaps() const {
    return gaps_;
  }
  // REQUIRES: not empty()
  [[nodiscard]] std::int64_t newest_ns() const { return samples_.back().stamp_ns; }
  [[nodiscard]] std::int64_t received_utc_ns() const { return received_utc_ns_; }
  // Of the first sample that came at this instant or later; nothing: none has.
  [[nodiscard]] std::optional<std::int64_t> first_stamp_since(Instant instant) const;
  // Of the samples held; 0: not known.
  [[nodiscard]] double rate_hz() const;
  // The newest samples without a gap, `most` at most, oldest first.
  [[nodiscard]] std::vector<Sample> newest_stretch(std::size_t most) const;

private:
  void push_one(const Sample& sample);

  std::deque<Sample> samples_;
  std::deque<Extremes> extremes_;
  std::deque<std::pair<std::int64_t, std::int64_t>> gaps_;
  std::deque<std::pair<Instant, std::int64_t>> arrivals_; // first stamps of blocks
  std::int64_t received_utc_ns_ = 0;
};

} // namespace dyncal::inline views
