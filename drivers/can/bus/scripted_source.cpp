#include "drivers/can/bus/scripted_source.hpp"

#include <algorithm>

namespace dyncal::drivers::can {

Expected<LinkState> ScriptedSource::open(const std::vector<FrameFilter>& filters) {
  filters_ = filters;
  return link_;
}

Expected<ReadState> ScriptedSource::read(std::vector<BusEvent>& events,
                                         std::chrono::milliseconds /*limit*/) {
  if (stop_.raised()) {
    return ReadState::stopped;
  }
  const auto passes = [&](const CanFrame& frame) {
    return std::any_of(filters_.begin(), filters_.end(),
                       [&](const FrameFilter& filter) { return filter.passes(frame); });
  };
  for (std::size_t given = 0; given < batch_ && next_ < events_.size(); ++next_) {
    const auto* frame = std::get_if<CanFrame>(&events_[next_]);
    if (frame != nullptr && !passes(*frame)) {
      continue;
    }
    events.push_back(events_[next_]);
    ++given;
  }
  return next_ < events_.size() ? ReadState::more : ReadState::ended;
}

} // namespace dyncal::drivers::can
