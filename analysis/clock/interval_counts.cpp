#include "analysis/clock/interval_counts.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace dyncal::analysis {
namespace {

std::int64_t floor_divide(std::int64_t value, std::int64_t divisor) {
  const std::int64_t quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}

} // namespace

IntervalDistribution::IntervalDistribution(std::vector<Entry> sorted)
    : entries_(std::move(sorted)) {
  for (const Entry& entry : entries_) {
    count_ += entry.second;
    up_to_.push_back(count_);
  }
}

double IntervalDistribution::order_statistic(std::uint64_t rank) const {
  const auto entry = std::upper_bound(up_to_.begin(), up_to_.end(), rank);
  return static_cast<double>(entries_[static_cast<std::size_t>(entry - up_to_.begin())].first);
}

double IntervalDistribution::quantile(double probability) const {
  assert(count_ > 0);
  const double place = static_cast<double>(count_ - 1) * probability;
  const auto below = static_cast<std::uint64_t>(place);
  const double low = order_statistic(below);
  if (below + 1 >= count_) {
    return low;
  }
  return low + (place - static_cast<double>(below)) * (order_statistic(below + 1) - low);
}

double IntervalDistribution::median_absolute_deviation() const {
  const double centre = quantile(0.5);
  std::vector<std::pair<double, std::uint64_t>> deviations;
  for (const Entry& entry : entries_) {
    deviations.emplace_back(std::abs(static_cast<double>(entry.first) - centre), entry.second);
  }
  std::sort(deviations.begin(), deviations.end());
  const auto at_rank = [&](std::uint64_t rank) {
    std::uint64_t counted = 0;
    for (const auto& [deviation, times] : deviations) {
      if ((counted += times) > rank) {
        return deviation;
      }
    }
    return deviations.back().first;
  };
  return 0.5 * (at_rank((count_ - 1) / 2) + at_rank(count_ / 2));
}

IntervalDistribution
IntervalDistribution::without(const std::vector<std::int64_t>& lengths_ns) const {
  std::vector<Entry> left = entries_;
  for (const std::int64_t length : lengths_ns) {
    const auto above = std::lower_bound(left.begin(), left.end(), Entry{length, 0});
    const auto below = above == left.begin() ? above : std::prev(above);
    const bool is_above =
        above != left.end() && (above == below || above->first - length <= length - below->first);
    Entry& nearest = is_above ? *above : *below;
    nearest.second -= nearest.second > 0 ? 1 : 0;
  }
  std::erase_if(left, [](const Entry& entry) { return entry.second == 0; });
  return IntervalDistribution(std::move(left));
}

void IntervalSums::add(std::int64_t interval_ns) {
  if (count == 0) {
    pivot_ns = interval_ns;
  }
  const std::int64_t deviation = interval_ns - pivot_ns;
  ++count;
  sum_ns += deviation;
  squares_ns2 += static_cast<long double>(deviation) * static_cast<long double>(deviation);
}

void IntervalSums::remove(std::int64_t interval_ns) {
  const std::int64_t deviation = interval_ns - pivot_ns;
  --count;
  sum_ns -= deviation;
  squares_ns2 -= static_cast<long double>(deviation) * static_cast<long double>(deviation);
}

double IntervalSums::mean_ns() const {
  return static_cast<double>(static_cast<long double>(pivot_ns) +
                             static_cast<long double>(sum_ns) / static_cast<long double>(count));
}

double IntervalSums::sd_ns() const {
  const auto n = static_cast<long double>(count);
  const auto sum = static_cast<long double>(sum_ns);
  return static_cast<double>(std::sqrt(std::max(0.0L, squares_ns2 - sum * sum / n) / (n - 1.0L)));
}

IntervalCounts::IntervalCounts(std::size_t max_distinct)
    : max_distinct_(std::max<std::size_t>(max_distinct, 16)) {}

void IntervalCounts::add(std::int64_t interval_ns) {
  minimum_ns_ = sums_.count == 0 ? interval_ns : std::min(minimum_ns_, interval_ns);
  maximum_ns_ = sums_.count == 0 ? interval_ns : std::max(maximum_ns_, interval_ns);
  sums_.add(interval_ns);
  ++counts_[floor_divide(interval_ns, resolution_ns_)];
  while (counts_.size() > max_distinct_) {
    coarsen();
  }
}

void IntervalCounts::coarsen() {
  std::unordered_map<std::int64_t, std::uint64_t> coarser;
  for (const auto& [length, times] : counts_) {
    coarser[floor_divide(length, 2)] += times;
  }
  counts_ = std::move(coarser);
  resolution_ns_ *= 2;
}

IntervalDistribution IntervalCounts::distribution() const {
  std::vector<IntervalDistribution::Entry> entries;
  entries.reserve(counts_.size());
  for (const auto& [length, times] : counts_) {
    entries.emplace_back(length * resolution_ns_ + resolution_ns_ / 2, times);
  }
  std::sort(entries.begin(), entries.end());
  return IntervalDistribution(std::move(entries));
}

} // namespace dyncal::analysis
