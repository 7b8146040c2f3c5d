// Finds the next whole chunk of a recording, where what stands before it is no record.
//
// A chunk is known by its lengths, which fit together in few places by chance, and then by its CRC.
// Bound: `max_failed_candidates` whose CRC was wrong, in a file. Fails as reading does, and with
// what `walk_to` says. One thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "services/records/mcap/recording_reader.hpp"

namespace dyncal::inline records::recording {

class ChunkSearch {
public:
  static constexpr int max_failed_candidates = 100;
  static constexpr std::uint64_t window_bytes = std::uint64_t{1} << 20U;
  // Of so many bytes of the file that are behind; a failure stops the search.
  using WalkTo = std::function<base::Expected<void>(std::uint64_t)>;

  // `reader` outlives the object.
  explicit ChunkSearch(const RecordingReader& reader) : reader_(reader) {}

  // Where the first one from `offset` on begins; nothing: there is none.
  [[nodiscard]] base::Expected<std::optional<std::uint64_t>> next(std::uint64_t offset,
                                                                  const WalkTo& walk_to);

private:
  [[nodiscard]] base::Expected<bool> is_whole(std::uint64_t offset);

  const RecordingReader& reader_;
  int failed_candidates_ = 0;
};

} // namespace dyncal::inline records::recording
