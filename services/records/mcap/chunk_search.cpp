#include "services/records/mcap/chunk_search.hpp"

#include <algorithm>

#include "services/records/mcap/chunk_codec.hpp"

namespace dyncal::inline records::recording {

using base::Expected;

namespace {

constexpr std::size_t chunk_fields_bytes = head_bytes + 44; // with a compression of 4 letters

} // namespace

Expected<std::optional<std::uint64_t>> ChunkSearch::next(std::uint64_t from,
                                                         const WalkTo& walk_to) {
  while (from + chunk_fields_bytes <= reader_.size_bytes()) {
    const std::uint64_t count = std::min(window_bytes, reader_.size_bytes() - from);
    DYNCAL_TRY(const auto window, reader_.bytes(from, count));
    for (std::size_t at = window.find('\x06'); at != std::string::npos;
         at = window.find('\x06', at + 1)) {
      DYNCAL_TRY(const auto whole, is_whole(from + at));
      if (whole) {
        return from + at;
      }
    }
    from += count;
    DYNCAL_TRY(walk_to(from));
  }
  return std::nullopt;
}

// By its lengths, which fit together in few places by chance, and then by its CRC.
Expected<bool> ChunkSearch::is_whole(std::uint64_t offset) {
  const std::uint64_t left = reader_.size_bytes() - offset;
  if (left < chunk_fields_bytes || failed_candidates_ >= max_failed_candidates) {
    return false;
  }
  DYNCAL_TRY(const auto fields, reader_.bytes(offset, chunk_fields_bytes));
  const std::uint64_t length = number_at(fields, 1, 8);
  const std::uint64_t letters = number_at(fields, head_bytes + 28, 4);
  if (length > left - head_bytes || length > max_record_bytes || letters > 4 || length < 44 ||
      number_at(fields, head_bytes + 32 + letters, 8) != length - 40 - letters) {
    return false;
  }
  const bool whole =
      reader_.chunk_records(offset).has_value() && number_at(fields, head_bytes + 24, 4) != 0;
  failed_candidates_ += whole ? 0 : 1;
  return whole;
}

} // namespace dyncal::inline records::recording
