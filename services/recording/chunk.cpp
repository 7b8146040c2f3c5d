#include "services/recording/chunk.hpp"

#include <algorithm>

namespace dyncal::recording {

void Chunk::add(const Channel& channel, const Message& message) {
  std::vector<IndexEntry>& entries = index_[channel.id];
  if (entries.empty()) {
    append_channel(records_, channel);
  }
  entries.push_back({message.log_time, records_.size()});
  append_message(records_, message);
  first_time_ = messages_ == 0 ? message.log_time : std::min(first_time_, message.log_time);
  last_time_ = std::max(last_time_, message.log_time);
  ++messages_;
}

} // namespace dyncal::recording
