#include "analysis/clock/interval_overview.hpp"

#include <algorithm>

namespace dyncal::analysis {

IntervalOverview::IntervalOverview(std::size_t max_buckets)
    : max_buckets_(std::max<std::size_t>(max_buckets, 2) / 2 * 2) {}

void IntervalOverview::add(const SampleInterval& interval) {
  if (buckets_.empty() || buckets_.back().count == per_bucket_) {
    if (buckets_.size() == max_buckets_) {
      halve();
    }
    if (buckets_.empty() || buckets_.back().count == per_bucket_) {
      buckets_.push_back(
          {interval.begin_ns, interval.length_ns, interval.length_ns, interval.length_ns, 1});
      return;
    }
  }
  Bucket& bucket = buckets_.back();
  bucket.minimum_ns = std::min(bucket.minimum_ns, interval.length_ns);
  bucket.maximum_ns = std::max(bucket.maximum_ns, interval.length_ns);
  bucket.sum_ns += interval.length_ns;
  ++bucket.count;
}

void IntervalOverview::halve() {
  for (std::size_t i = 0; i < buckets_.size() / 2; ++i) {
    const Bucket& a = buckets_[2 * i];
    const Bucket& b = buckets_[2 * i + 1];
    buckets_[i] = {a.begin_ns, std::min(a.minimum_ns, b.minimum_ns),
                   std::max(a.maximum_ns, b.maximum_ns), a.sum_ns + b.sum_ns, a.count + b.count};
  }
  buckets_.resize(buckets_.size() / 2);
  per_bucket_ *= 2;
}

std::vector<IntervalBucket> IntervalOverview::buckets(std::int64_t first_stamp_ns) const {
  std::vector<IntervalBucket> result;
  for (const Bucket& bucket : buckets_) {
    result.push_back({static_cast<double>(bucket.begin_ns - first_stamp_ns) * 1e-9,
                      static_cast<double>(bucket.minimum_ns),
                      static_cast<double>(bucket.maximum_ns),
                      static_cast<double>(bucket.sum_ns) / static_cast<double>(bucket.count)});
  }
  return result;
}

void IntervalCloseUp::add(const SampleInterval& interval, const UsualInterval& usual) {
  if (still_wanted_ && *still_wanted_ == 0) {
    return;
  }
  if (!interval.continues && !still_wanted_) {
    recent_.clear();
  }
  if (!still_wanted_ && usual.known() && !recent_.empty()) {
    const double before = static_cast<double>(recent_.back().length_ns) - usual.median_ns;
    const double now = static_cast<double>(interval.length_ns) - usual.median_ns;
    const bool unusual =
        !usual.is_core(interval.length_ns, 6.0) && !usual.is_core(recent_.back().length_ns, 6.0);
    if (unusual && before * now < 0.0 && std::abs(before + now) < 9.0 * usual.scale_ns) {
      still_wanted_ = each_side_;
    }
  }
  recent_.push_back({interval.begin_ns, interval.length_ns});
  if (still_wanted_) {
    --*still_wanted_;
  } else if (recent_.size() > each_side_ + 1) {
    recent_.erase(recent_.begin());
  }
}

std::vector<double> IntervalCloseUp::lengths_ns() const {
  std::vector<double> result;
  if (!still_wanted_) {
    return result;
  }
  for (const RecentInterval& interval : recent_) {
    result.push_back(static_cast<double>(interval.length_ns));
  }
  return result;
}

} // namespace dyncal::analysis
