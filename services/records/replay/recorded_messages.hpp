// Messages of a recording by their places (recording_index.hpp), in any order.
//
// Holds the records of one chunk: anyone who asks in about the order of the file reads each chunk
// once. Fails (bad_file) with what is wrong with the chunk. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "services/records/mcap/recording_reader.hpp"
#include "services/records/replay/recording_index.hpp"

namespace dyncal::inline records {

class RecordedMessages {
public:
  // `reader` outlives the object.
  explicit RecordedMessages(const recording::RecordingReader& reader) : reader_(reader) {}

  // Its data last until the next call.
  [[nodiscard]] Expected<recording::Message> at(const RecordedPlace& place);

private:
  const recording::RecordingReader& reader_;
  std::optional<std::string> records_;
  std::uint64_t chunk_ = 0;
};

} // namespace dyncal::inline records
