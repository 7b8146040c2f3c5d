// How often each sample interval occurred: counts of whole nanoseconds, and the statistics that
// follow from them exactly.
//
// Mean and standard deviation (n - 1) come from integer sums about the first interval; median,
// quantiles and MAD from the counts, quantiles linear between order statistics (x_(h), h = (n - 1)
// p). With more distinct lengths than the bound the counts, and only they, are kept in steps of 2,
// 4, 8 ... ns. Units: ns. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace dyncal::analysis {

class IntervalDistribution { // sorted lengths with their counts
public:
  using Entry = std::pair<std::int64_t, std::uint64_t>;

  explicit IntervalDistribution(std::vector<Entry> sorted);

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  [[nodiscard]] std::uint64_t count() const { return count_; }
  // REQUIRES (both): not empty; 0 <= probability <= 1.
  [[nodiscard]] double quantile(double probability) const;
  [[nodiscard]] double median_absolute_deviation() const; // about the median, not scaled
  // Without one interval each of these lengths, where there is one (of the nearest that is kept).
  [[nodiscard]] IntervalDistribution without(const std::vector<std::int64_t>& lengths_ns) const;

private:
  [[nodiscard]] double order_statistic(std::uint64_t rank) const;
  std::vector<Entry> entries_;
  std::vector<std::uint64_t> up_to_; // cumulated counts
  std::uint64_t count_ = 0;
};

struct IntervalSums { // about `pivot_ns`
  std::int64_t pivot_ns = 0;
  std::uint64_t count = 0;
  std::int64_t sum_ns = 0;
  long double squares_ns2 = 0.0L;

  void add(std::int64_t interval_ns);
  void remove(std::int64_t interval_ns);
  [[nodiscard]] double mean_ns() const; // REQUIRES: count > 0
  [[nodiscard]] double sd_ns() const;   // REQUIRES: count > 1
};

class IntervalCounts {
public:
  explicit IntervalCounts(std::size_t max_distinct);

  void add(std::int64_t interval_ns);
  [[nodiscard]] const IntervalSums& sums() const { return sums_; }
  [[nodiscard]] std::int64_t minimum_ns() const { return minimum_ns_; }
  [[nodiscard]] std::int64_t maximum_ns() const { return maximum_ns_; }
  [[nodiscard]] IntervalDistribution distribution() const;

private:
  void coarsen();
  std::size_t max_distinct_;
  std::int64_t resolution_ns_ = 1;
  std::int64_t minimum_ns_ = 0;
  std::int64_t maximum_ns_ = 0;
  IntervalSums sums_;
  std::unordered_map<std::int64_t, std::uint64_t> counts_; // by length / resolution, rounded down
};

} // namespace dyncal::analysis
