// Intervals that are not as usual, and what they are.
//
// With the interval d, the median m and s = 1.4826 MAD (at least half a nanosecond):
//
//   backward   d < 0
//   duplicate  0 <= d <= 0.02 m
//   gap        |d - k m| < max(8 s sqrt(k), 0.02 m), k = 2, 3 ...; k - 1 samples are missing
//   pair       |d - m| > 6 s and the next interval deviates the other way, the two sum to less than
//              9 s: one late or early sample
//   step       |d - m| > 6 s otherwise: stamps have moved against the samples for good
//
// The collector keeps every interval that lies outside 4 s of what was usual up to then (all of the
// first 64), up to a bound, and counts the rest; the verdict comes at the end, with the final m and
// s. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyncal::analysis {

struct UsualInterval {
  double median_ns = 0.0;
  double scale_ns = 0.0; // s

  [[nodiscard]] bool known() const { return median_ns > 0.0; }
  [[nodiscard]] bool is_core(std::int64_t interval_ns, double times) const;
};

struct SampleInterval {
  std::uint64_t ordinal = 0; // of the interval, counting those that were measured
  std::uint64_t sample = 0;  // number of the sample that begins it
  std::int64_t begin_ns = 0; // its stamp
  std::int64_t length_ns = 0;
  bool continues = true; // the interval before was measured too and ends where this begins
};

struct IntervalEvent {
  std::string kind;
  std::uint64_t sample = 0; // number of the sample that begins the interval
  double time_s = 0.0;      // since the first sample
  double size_ns = 0.0;     // deviation from the median
  std::uint32_t missing = 0;
};

struct IntervalVerdict {
  std::vector<IntervalEvent> events;            // at most as many as were asked for
  std::uint64_t event_count = 0;                // all
  std::vector<std::int64_t> unusual_lengths_ns; // of every interval that is part of an event
  std::vector<std::int64_t> gap_lengths_ns;     // of these, where samples are missing
  std::uint64_t pair_count = 0;
  double pair_period_samples =
      0.0; // median distance of pairs; 0 with fewer than five, or without regularity (below 0.9)
  double pair_period_s = 0.0;
  double pair_regularity =
      0.0; // |mean exp(2 pi i distance / period)|: 1 regular, towards 0 by chance
};

class IntervalEventCollector {
public:
  explicit IntervalEventCollector(std::size_t max_kept = 100'000) : max_kept_(max_kept) {}

  void add(const SampleInterval& interval, const UsualInterval& usual);
  [[nodiscard]] IntervalVerdict judge(const UsualInterval& usual, std::int64_t first_stamp_ns,
                                      std::size_t max_events) const;

private:
  std::size_t max_kept_;
  std::vector<SampleInterval> kept_;
  std::uint64_t not_kept_ = 0;
};

} // namespace dyncal::analysis
