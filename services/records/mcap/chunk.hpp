// The messages of a stretch of time, as they will stand in one chunk of the file, with their index.
//
// Each channel stands in every chunk that has messages of it, before them, so that the chunk's CRC
// holds which topic a message is of. A plain value, passed from the thread that receives to the one
// that writes; one thread at a time.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "services/records/mcap/mcap_record.hpp"

namespace dyncal::inline records::recording {

class Chunk {
public:
  void add(const Channel& channel, const Message& message);

  [[nodiscard]] bool empty() const { return messages_ == 0; }
  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  [[nodiscard]] std::uint64_t first_time() const { return first_time_; }
  [[nodiscard]] std::uint64_t last_time() const { return last_time_; }
  [[nodiscard]] const std::string& records() const { return records_; }
  // Of the records; summed by the thread that adds them, so that the one that writes only writes.
  [[nodiscard]] std::uint32_t crc() const { return crc_; }
  [[nodiscard]] const std::map<std::uint16_t, std::vector<IndexEntry>>& index() const {
    return index_;
  }
  // For a chunk of about this size.
  void reserve(std::size_t bytes) { records_.reserve(bytes); }

private:
  std::string records_;
  std::uint32_t crc_ = 0;
  std::map<std::uint16_t, std::vector<IndexEntry>> index_;
  std::uint64_t messages_ = 0;
  std::uint64_t first_time_ = 0;
  std::uint64_t last_time_ = 0;
};

} // namespace dyncal::inline records::recording
