#include "services/records/mcap/chunk.hpp"

#include <algorithm>
#include <string_view>

namespace dyncal::inline records::recording {

void Chunk::add(const Channel& channel, const Message& message) {
  const std::size_t begin = records_.size();
  std::vector<IndexEntry>& entries = index_[channel.id];
  if (entries.empty()) {
    append_channel(records_, channel);
  }
  entries.push_back({message.log_time, records_.size()});
  append_message(records_, message);
  crc_ = crc32_of(std::string_view(records_).substr(begin), crc_);
  first_time_ = messages_ == 0 ? message.log_time : std::min(first_time_, message.log_time);
  last_time_ = std::max(last_time_, message.log_time);
  ++messages_;
}

} // namespace dyncal::inline records::recording
