// Two bounded views of a long record of intervals, made as it passes.
//
// An overview over time, whose buckets double their length whenever there would be too many, and a
// close-up of the intervals around the first late or early sample. Units: ns, int64 stamps. One
// thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "analysis/clock/interval_events.hpp"

namespace dyncal::analysis {

struct IntervalBucket {
  double time_s = 0.0; // of its first interval, since the first sample
  double minimum_ns = 0.0;
  double maximum_ns = 0.0;
  double mean_ns = 0.0;
};

class IntervalOverview {
public:
  explicit IntervalOverview(std::size_t max_buckets);

  void add(const SampleInterval& interval);
  [[nodiscard]] std::vector<IntervalBucket> buckets(std::int64_t first_stamp_ns) const;

private:
  struct Bucket {
    std::int64_t begin_ns;
    std::int64_t minimum_ns;
    std::int64_t maximum_ns;
    std::int64_t sum_ns;
    std::uint64_t count;
  };
  void halve();
  std::size_t max_buckets_;
  std::uint64_t per_bucket_ = 1;
  std::vector<Bucket> buckets_;
};

class IntervalCloseUp {
public:
  // `each_side`: intervals before and after the first pair.
  explicit IntervalCloseUp(std::size_t each_side) : each_side_(each_side) {}

  void add(const SampleInterval& interval, const UsualInterval& usual);
  [[nodiscard]] std::vector<double> lengths_ns() const; // empty while there was no pair
  [[nodiscard]] std::int64_t first_begin_ns() const {
    return recent_.empty() ? 0 : recent_.front().length_begin_ns;
  }

private:
  struct RecentInterval {
    std::int64_t length_begin_ns;
    std::int64_t length_ns;
  };
  std::size_t each_side_;
  std::vector<RecentInterval> recent_;
  std::optional<std::size_t> still_wanted_; // since the pair was seen
};

} // namespace dyncal::analysis
