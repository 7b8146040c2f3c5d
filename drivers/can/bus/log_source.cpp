#include "drivers/can/bus/log_source.hpp"

#include <algorithm>
#include <utility>

#include "drivers/can/bus/candump_log.hpp"

namespace dyncal::drivers::can {

namespace {

constexpr std::size_t batch = 256; // frames given at a time

} // namespace

Expected<LinkState> LogSource::open(const std::vector<FrameFilter>& filters) {
  DYNCAL_TRY(const auto log, read_candump_log(path_, interface_name_));
  for (const CanFrame& frame : log.frames) {
    const auto passes = [&](const FrameFilter& filter) { return filter.passes(frame); };
    if (std::any_of(filters.begin(), filters.end(), passes)) {
      frames_.push_back(frame);
    }
  }
  if (frames_.empty()) {
    return fail(ErrorCode::not_found,
                path_.string() + " has none of the sensor's messages" +
                    (interface_name_.empty() ? "" : " on interface '" + interface_name_ + "'") +
                    "; check 'messages', 'dbc' and 'interface'");
  }
  LinkState link;
  link.name = path_.filename().string();
  link.present = link.up = link.carrier = true;
  link.kind = "log";
  if (log.passed_over > 0) {
    warning_ =
        LinkChange{.link = link,
                   .interrupted = false,
                   .what = path_.string() + ": " + std::to_string(log.passed_over) +
                           " lines are not of candump and are passed over, the first is line " +
                           std::to_string(log.first_passed_over)};
  }
  return link;
}

LogSource::Clock::time_point LogSource::due(const CanFrame& frame) const {
  const double after_s =
      static_cast<double>(frame.kernel_ns - frames_.front().kernel_ns) * 1e-9 / speed_;
  return begin_ + std::chrono::duration_cast<Clock::duration>(
                      std::chrono::duration<double>(std::max(0.0, after_s)));
}

bool LogSource::wait_for_next(std::chrono::milliseconds limit) {
  if (begin_ == Clock::time_point{}) {
    begin_ = Clock::now();
  }
  if (speed_ <= 0.0) {
    return true;
  }
  const Clock::time_point when = due(frames_[next_]);
  static_cast<void>(stop_.wait_for(std::min<Clock::duration>(when - Clock::now(), limit)));
  return Clock::now() >= when;
}

Expected<ReadState> LogSource::read(std::vector<BusEvent>& events,
                                    std::chrono::milliseconds limit) {
  const bool something = next_ < frames_.size() && wait_for_next(limit);
  if (stop_.raised()) {
    return ReadState::stopped;
  }
  if (warning_) {
    events.emplace_back(std::move(*warning_));
    warning_.reset();
  }
  const Clock::time_point now = Clock::now();
  for (std::size_t given = 0; something && given < batch && next_ < frames_.size(); ++given) {
    if (speed_ > 0.0 && due(frames_[next_]) > now) {
      break;
    }
    events.emplace_back(frames_[next_++]);
  }
  return next_ < frames_.size() ? ReadState::more : ReadState::ended;
}

} // namespace dyncal::drivers::can
