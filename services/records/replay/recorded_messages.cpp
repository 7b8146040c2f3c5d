#include "services/records/replay/recorded_messages.hpp"

#include <string_view>

namespace dyncal::inline records {

Expected<recording::Message> RecordedMessages::at(const RecordedPlace& place) {
  if (!records_ || chunk_ != place.chunk) {
    DYNCAL_TRY(records_, reader_.chunk_records(place.chunk));
    chunk_ = place.chunk;
  }
  const std::string_view records = *records_;
  const std::uint64_t length = recording::number_at(records, place.position + 1, 8);
  return *recording::parse_message(records.substr(place.position + recording::head_bytes, length));
}

} // namespace dyncal::inline records
