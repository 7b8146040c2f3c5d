// Which message of a DBC file a frame is, and the kernel filters that let just those frames
// through.
//
// Ordinary messages match by their whole id. J1939 messages match by their parameter group number
// alone: priority and source address are ignored, and of PDU1 groups (PF < 240) the destination
// too. Where several messages have one id the first counts. Immutable after construction; any
// thread.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "drivers/can/bus/can_frame.hpp"
#include "drivers/can/bus/frame_filter.hpp"
#include "drivers/can/dbc/dbc.hpp"

namespace dyncal::drivers::can {

[[nodiscard]] FrameFilter filter_of(const DbcMessage& message);

class MessageIndex {
public:
  // The messages outlive the index.
  explicit MessageIndex(const std::vector<const DbcMessage*>& messages);

  // Null: none of the messages. Remote frames carry no data and are none.
  [[nodiscard]] const DbcMessage* find(const CanFrame& frame) const;
  [[nodiscard]] const std::vector<FrameFilter>& filters() const { return filters_; }

private:
  std::unordered_map<std::uint64_t, const DbcMessage*> exact_;
  std::unordered_map<std::uint32_t, const DbcMessage*> by_group_;
  std::vector<FrameFilter> filters_;
};

} // namespace dyncal::drivers::can
