#include "services/views/signals/channel_ring.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::inline views {

void ChannelRing::clear() {
  samples_.clear();
  extremes_.clear();
  gaps_.clear();
  arrivals_.clear();
}

void ChannelRing::push(std::span<const std::int64_t> stamps_ns, std::span<const double> values,
                       bool missing, std::int64_t received_utc_ns, Instant came) {
  const std::size_t count = std::min(stamps_ns.size(), values.size());
  if (count == 0) {
    return;
  }
  received_utc_ns_ = received_utc_ns;
  if (!samples_.empty() && stamps_ns.front() <= newest_ns()) {
    clear(); // another session
  } else if (!samples_.empty() && missing) {
    gaps_.emplace_back(newest_ns(), stamps_ns.front());
    if (gaps_.size() > max_gaps) {
      gaps_.pop_front();
    }
  }
  arrivals_.emplace_back(came, stamps_ns.front());
  if (arrivals_.size() > max_arrivals) {
    arrivals_.pop_front();
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isfinite(values[i]) && (samples_.empty() || stamps_ns[i] > newest_ns())) {
      push_one({stamps_ns[i], values[i]});
    }
  }
}

void ChannelRing::push_one(const Sample& sample) {
  samples_.push_back(sample);
  if (samples_.size() > max_samples) {
    samples_.pop_front();
  }
  if (extremes_.empty() || sample.stamp_ns - extremes_.back().begin_ns >= extremes_ns) {
    extremes_.push_back({sample.stamp_ns, sample.value, sample.value});
    if (extremes_.size() > max_extremes) {
      extremes_.pop_front();
    }
  } else {
    extremes_.back().minimum = std::min(extremes_.back().minimum, sample.value);
    extremes_.back().maximum = std::max(extremes_.back().maximum, sample.value);
  }
}

std::optional<std::int64_t> ChannelRing::first_stamp_since(Instant instant) const {
  const auto first =
      std::lower_bound(arrivals_.begin(), arrivals_.end(), instant,
                       [](const auto& arrival, Instant asked) { return arrival.first < asked; });
  return first == arrivals_.end() ? std::nullopt : std::optional(first->second);
}

double ChannelRing::rate_hz() const {
  if (samples_.size() < 2) {
    return 0.0;
  }
  const auto span_ns = static_cast<double>(newest_ns() - samples_.front().stamp_ns);
  return static_cast<double>(samples_.size() - 1) * 1e9 / span_ns;
}

std::vector<Sample> ChannelRing::newest_stretch(std::size_t most) const {
  const std::size_t count = std::min(most, samples_.size());
  auto first = samples_.end() - static_cast<std::ptrdiff_t>(count);
  if (!gaps_.empty()) {
    first = std::max(first, std::lower_bound(samples_.begin(), samples_.end(), gaps_.back().second,
                                             [](const Sample& sample, std::int64_t stamp_ns) {
                                               return sample.stamp_ns < stamp_ns;
                                             }));
  }
  return {first, samples_.end()};
}

} // namespace dyncal::inline views
