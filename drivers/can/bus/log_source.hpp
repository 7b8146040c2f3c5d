// A recorded candump log as a frame source: the frames of one interface in their order, with the
// stamps of the log.
//
// `speed` 0 delivers them as fast as they are read; otherwise each frame comes when as much time
// has passed as lay between it and the first frame of the log, divided by the speed. The source
// ends after the last frame. A log knows neither bit rate nor losses of the recorder.
//
// Fails at open() as read_candump_log does, and when no frame of the log passes the filters.
// Threads as FrameSource.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/bus/frame_source.hpp"

namespace dyncal::drivers::can {

class LogSource : public FrameSource {
public:
  // All interfaces of the log when `interface_name` is empty.
  LogSource(std::filesystem::path path, std::string interface_name, double speed)
      : path_(std::move(path)), interface_name_(std::move(interface_name)), speed_(speed) {}

  [[nodiscard]] Expected<LinkState> open(const std::vector<FrameFilter>& filters) override;
  [[nodiscard]] Expected<ReadState> read(std::vector<BusEvent>& events,
                                         std::chrono::milliseconds limit) override;

private:
  using Clock = std::chrono::steady_clock;

  // Whether the next frame may be given within `limit`; waits for it.
  [[nodiscard]] bool wait_for_next(std::chrono::milliseconds limit);
  [[nodiscard]] Clock::time_point due(const CanFrame& frame) const;

  std::filesystem::path path_;
  std::string interface_name_;
  double speed_;
  std::vector<CanFrame> frames_;
  std::optional<LinkChange> warning_; // of lines that were passed over
  std::size_t next_ = 0;
  Clock::time_point begin_{};
};

} // namespace dyncal::drivers::can
