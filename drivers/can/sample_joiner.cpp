#include "drivers/can/sample_joiner.hpp"

#include <algorithm>

namespace dyncal::drivers::can {

bool SampleJoiner::recently_left(std::uint64_t key) const {
  return std::find(left_.begin(), left_.end(), key) != left_.end();
}

std::optional<JoinedSample> SampleJoiner::add(std::size_t message, std::uint64_t key,
                                              const CanFrame& frame) {
  if (messages_ == 1) {
    return JoinedSample{key, {frame}};
  }
  auto sample = std::find_if(open_.begin(), open_.end(),
                             [key](const JoinedSample& open) { return open.key == key; });
  if (sample == open_.end()) {
    if (recently_left(key)) { // a frame that comes again, or too late
      ++counts_.repeated;
      return std::nullopt;
    }
    if (open_.size() == max_open) {
      left_.push_back(open_.front().key);
      open_.pop_front();
      ++counts_.incomplete;
    }
    open_.push_back({key, std::vector<std::optional<CanFrame>>(messages_)});
    sample = std::prev(open_.end());
  }
  if (sample->frames[message]) {
    ++counts_.repeated;
    return std::nullopt;
  }
  sample->frames[message] = frame;
  if (!std::all_of(sample->frames.begin(), sample->frames.end(),
                   [](const auto& part) { return part.has_value(); })) {
    return std::nullopt;
  }
  // What began before this one is out of order by now only if it can never be completed: a device
  // sends its samples one after the other.
  while (open_.begin() != sample) {
    left_.push_back(open_.front().key);
    open_.pop_front();
    ++counts_.incomplete;
    sample = std::find_if(open_.begin(), open_.end(),
                          [key](const JoinedSample& open) { return open.key == key; });
  }
  JoinedSample joined = std::move(open_.front());
  open_.pop_front();
  left_.push_back(key);
  while (left_.size() > max_open) {
    left_.pop_front();
  }
  return joined;
}

void SampleJoiner::give_up_open() {
  counts_.incomplete += open_.size();
  open_.clear();
  left_.clear();
}

} // namespace dyncal::drivers::can
