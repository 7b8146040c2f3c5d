// A frame source whose events were written down beforehand, with their own stamps: for tests.
//
// Delivers them in order, `batch` at a time, then ends. Threads as FrameSource.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "drivers/can/bus/frame_source.hpp"

namespace dyncal::drivers::can {

class ScriptedSource : public FrameSource {
public:
  ScriptedSource(LinkState link, std::vector<BusEvent> events, std::size_t batch = 64)
      : link_(std::move(link)), events_(std::move(events)), batch_(batch) {}

  [[nodiscard]] Expected<LinkState> open(const std::vector<FrameFilter>& filters) override;
  [[nodiscard]] Expected<ReadState> read(std::vector<BusEvent>& events,
                                         std::chrono::milliseconds limit) override;

private:
  LinkState link_;
  std::vector<BusEvent> events_;
  std::size_t batch_;
  std::size_t next_ = 0;
  std::vector<FrameFilter> filters_;
};

} // namespace dyncal::drivers::can
