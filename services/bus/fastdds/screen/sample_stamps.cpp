#include "services/bus/fastdds/screen/sample_stamps.hpp"

namespace dyncal::bus {

void SampleStamps::begin(const Sample& sample, std::optional<RtpsStamp> stamp) {
  const std::lock_guard lock(mutex_);
  if (!stamps_.insert_or_assign(sample, stamp.value_or(invalid)).second) {
    return; // sent again
  }
  oldest_first_.push_back(sample);
  if (oldest_first_.size() > max_samples) {
    stamps_.erase(oldest_first_.front());
    oldest_first_.pop_front();
  }
}

std::optional<RtpsStamp> SampleStamps::of(const Sample& sample) const {
  const std::lock_guard lock(mutex_);
  const auto found = stamps_.find(sample);
  return found == stamps_.end() ? std::nullopt : std::optional(found->second);
}

} // namespace dyncal::bus
