#include "drivers/can/message_index.hpp"

#include <algorithm>

namespace dyncal::drivers::can {

namespace {

constexpr std::uint32_t standard_ids = 0x7FF;
constexpr std::uint32_t extended_ids = 0x1FFFFFFF;

// Bits of a J1939 id that make up its parameter group: reserved and data page, PF and, from PF 240
// on, PS.
std::uint32_t group_mask(std::uint32_t id) {
  const std::uint32_t pdu_format = (id >> 16U) & 0xFFU;
  return pdu_format < 240 ? 0x03FF0000 : 0x03FFFF00;
}

std::uint64_t exact_key(std::uint32_t id, bool extended) {
  return (std::uint64_t{extended} << 32U) | id;
}

} // namespace

FrameFilter filter_of(const DbcMessage& message) {
  if (message.format == FrameFormat::j1939) {
    return {message.id & group_mask(message.id), group_mask(message.id), true};
  }
  return {message.id, message.extended ? extended_ids : standard_ids, message.extended};
}

MessageIndex::MessageIndex(const std::vector<const DbcMessage*>& messages) {
  for (const DbcMessage* message : messages) {
    const FrameFilter filter = filter_of(*message);
    if (message->format == FrameFormat::j1939) {
      by_group_.emplace(filter.id, message);
    } else {
      exact_.emplace(exact_key(message->id, message->extended), message);
    }
    if (std::find(filters_.begin(), filters_.end(), filter) == filters_.end()) {
      filters_.push_back(filter);
    }
  }
}

const DbcMessage* MessageIndex::find(const CanFrame& frame) const {
  if (frame.remote) {
    return nullptr;
  }
  if (const auto found = exact_.find(exact_key(frame.id, frame.extended)); found != exact_.end()) {
    return found->second;
  }
  if (!frame.extended) {
    return nullptr;
  }
  const auto found = by_group_.find(frame.id & group_mask(frame.id));
  return found == by_group_.end() ? nullptr : found->second;
}

} // namespace dyncal::drivers::can
