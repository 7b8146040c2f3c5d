#include "services/records/mcap/recording_ending.hpp"

#include <optional>

#include "services/records/mcap/chunk_codec.hpp"

namespace dyncal::inline records::recording {

using base::Expected;

namespace {

constexpr std::uint64_t footer_bytes = head_bytes + 20;

// What follows DataEnd at `begin`, up to and including Footer and magic.
Ending judge_ending(std::string_view text, std::uint64_t begin) {
  const std::size_t footer_at = text.size() - magic.size() - footer_bytes;
  const auto footer = parse_footer(text.substr(footer_at + head_bytes, 20));
  if (!footer || text.substr(text.size() - magic.size()) != magic) {
    return Ending::damaged;
  }
  if (footer->summary_start == 0) {
    return footer_at == 0 ? Ending::without_summary : Ending::damaged;
  }
  const std::string_view vouched = text.substr(0, text.size() - magic.size() - 4);
  const bool is_sound =
      footer->summary_start == begin && (footer->crc == 0 || footer->crc == crc32_of(vouched));
  return is_sound ? Ending::with_summary : Ending::damaged;
}

// Where the Footer behind DataEnd begins; nothing if there is none.
Expected<std::optional<std::uint64_t>> footer_behind(const RecordingReader& reader,
                                                     std::uint64_t offset) {
  while (reader.size_bytes() - offset >= footer_bytes + magic.size()) {
    DYNCAL_TRY(const auto head, reader.bytes(offset, head_bytes));
    const std::uint64_t length = number_at(head, 1, 8);
    if (static_cast<Opcode>(head[0]) == Opcode::footer) {
      return length == footer_bytes - head_bytes ? std::optional(offset) : std::nullopt;
    }
    if (length > reader.size_bytes() - offset - head_bytes) {
      break;
    }
    offset += head_bytes + length;
  }
  return std::nullopt;
}

} // namespace

Expected<Ending> ending_behind(const RecordingReader& reader, std::uint64_t begin) {
  DYNCAL_TRY(const auto footer, footer_behind(reader, begin));
  if (!footer || *footer - begin >= max_record_bytes) {
    return Ending::damaged;
  }
  DYNCAL_TRY(const auto text, reader.bytes(begin, *footer - begin + footer_bytes + magic.size()));
  return judge_ending(text, begin);
}

} // namespace dyncal::inline records::recording
