#include "services/records/mcap/scan.hpp"

#include <fmt/core.h>

#include "services/records/mcap/chunk_codec.hpp"
#include "services/records/mcap/recording_ending.hpp"
#include "services/records/mcap/text_crc.hpp"

namespace dyncal::inline records::recording {

using base::Expected;

namespace {

constexpr std::uint64_t max_filler_bytes = std::uint64_t{1} << 20U; // that is read

const char* name_of(Opcode opcode) {
  switch (opcode) {
  case Opcode::header:
    return "header";
  case Opcode::schema:
    return "schema";
  case Opcode::channel:
    return "channel";
  case Opcode::message:
    return "message";
  case Opcode::chunk:
    return "chunk";
  case Opcode::message_index:
    return "message index";
  case Opcode::attachment:
    return "attachment";
  case Opcode::metadata:
    return "metadata";
  default:
    return "record of an unknown kind";
  }
}

} // namespace

void Scan::damage(std::uint64_t offset, std::uint64_t bytes, std::string what) {
  ++report_.damage_count;
  if (report_.damages.size() < ScanReport::max_damages) {
    report_.damages.push_back({offset, bytes, std::move(what)});
  }
}

Expected<void> Scan::walk_to(std::uint64_t offset) const {
  if (!events_.walked || events_.walked(offset)) {
    return {};
  }
  return fail(base::ErrorCode::interrupted,
              fmt::format("{}: interrupted while it was read", reader_.path().string()));
}

Expected<ScanReport> Scan::run() {
  report_.file_bytes = reader_.size_bytes();
  offset_ = magic.size();
  crc_ = crc32_of(magic);
  for (;;) {
    DYNCAL_TRY(const auto goes_on, step());
    DYNCAL_TRY(walk_to(goes_on ? offset_ : reader_.size_bytes()));
    if (!goes_on) {
      return std::move(report_);
    }
  }
}

Expected<bool> Scan::step() {
  const std::uint64_t left = reader_.size_bytes() - offset_;
  if (left < head_bytes) {
    damage(offset_, left, "the file was cut off here");
    return false;
  }
  DYNCAL_TRY(const auto head, reader_.bytes(offset_, head_bytes));
  const auto opcode = static_cast<Opcode>(static_cast<std::uint8_t>(head[0]));
  const std::uint64_t length = number_at(head, 1, 8);
  const std::uint64_t begin = offset_;
  if (length > left - head_bytes) {
    return go_on_behind(begin).map([&] { return offset_ < reader_.size_bytes(); });
  }
  if (opcode == Opcode::filler && length > max_filler_bytes) { // of a recording that was not ended
    crc_.reset();
    offset_ += head_bytes + length;
    return true;
  }
  if (length > max_record_bytes) {
    damage(begin, head_bytes + length, "the record is longer than any that is read");
    crc_.reset();
    offset_ += head_bytes + length;
    return true;
  }
  DYNCAL_TRY(const auto content, reader_.bytes(begin + head_bytes, length));
  if (opcode == Opcode::data_end && length == 4) {
    const auto crc = static_cast<std::uint32_t>(number_at(content, 0, 4));
    return take_end(crc, begin + head_bytes + length).map([] { return false; });
  }
  const Finding finding = take(opcode, content);
  if (finding == Finding::unreadable) {
    return go_on_behind(begin).map([&] { return offset_ < reader_.size_bytes(); });
  }
  if (crc_) {
    crc_ = crc32_of(content, crc32_of(head, *crc_));
  }
  offset_ = begin + head_bytes + length;
  return true;
}

Scan::Finding Scan::take(Opcode opcode, const std::string& content) {
  const std::uint64_t bytes = head_bytes + content.size();
  switch (opcode) {
  case Opcode::header:
    if (auto library = parse_header(content); library && offset_ == magic.size()) {
      report_.library = std::move(*library);
      return Finding::sound;
    }
    return Finding::unreadable;
  case Opcode::schema:
  case Opcode::channel:
    return take_definition(opcode, content);
  case Opcode::message:
    return take_loose_message(content);
  case Opcode::chunk:
    return take_chunk(content);
  case Opcode::message_index:
    return is_message_index(content) ? Finding::sound : Finding::unreadable;
  case Opcode::attachment:
    if (const auto attachment = parse_attachment(content)) {
      if (events_.attachment) {
        events_.attachment(*attachment);
      }
      return Finding::sound;
    }
    damage(offset_, bytes, "the attachment is damaged");
    return Finding::damaged;
  case Opcode::metadata: {
    const auto metadata = parse_metadata(content);
    if (!metadata) {
      return Finding::unreadable;
    }
    const auto crc = metadata->entries.find(metadata_crc_key);
    if (crc != metadata->entries.end() && crc->second != metadata_crc(*metadata)) {
      damage(offset_, bytes, fmt::format("metadata '{}' are damaged", metadata->name));
      return Finding::damaged;
    }
    if (events_.metadata) {
      events_.metadata(*metadata);
    }
    return Finding::sound;
  }
  case Opcode::filler:
    return Finding::sound;
  default:
    return Finding::unreadable;
  }
}

// A file without chunks is of a writer that does so. Behind a chunk it may be another record whose
// kind was damaged.
Scan::Finding Scan::take_loose_message(std::string_view content) {
  if (report_.chunks > 0) {
    damage(offset_, head_bytes + content.size(),
           "a message outside chunks is not read: nothing shows that it is sound");
    return Finding::damaged;
  }
  ++report_.loose_messages;
  take_message(content, 0);
  return Finding::sound;
}

Scan::Finding Scan::take_definition(Opcode opcode, std::string_view content) {
  if (opcode == Opcode::channel) {
    auto channel = parse_channel(content);
    if (!channel) {
      return Finding::unreadable;
    }
    take_channel(std::move(*channel), false);
    return Finding::sound;
  }
  auto schema = parse_schema(content);
  if (!schema) {
    return Finding::unreadable;
  }
  const auto [known, is_new] = schemas_.try_emplace(schema->id, *schema);
  if (!is_new && known->second != *schema) {
    damage(offset_, head_bytes + content.size(),
           fmt::format("schema {} is there twice, with two contents", schema->id));
  }
  return Finding::sound;
}

// One in a chunk is the right one.
void Scan::take_channel(Channel channel, bool has_crc) {
  const std::uint16_t id = channel.id;
  const auto known = channels_.find(id);
  if (known == channels_.end()) {
    channels_.emplace(id, KnownChannel{std::move(channel), has_crc});
    return;
  }
  if (known->second.channel != channel) {
    damage(offset_, 0, fmt::format("channel {} is there twice, with two contents", id));
  }
  if (has_crc && !known->second.has_crc) {
    known->second = {std::move(channel), true};
    checked_.erase(id);
  }
}

Scan::Finding Scan::take_chunk(const std::string& content) {
  const auto chunk = parse_chunk(content);
  if (!chunk) {
    return Finding::unreadable;
  }
  ++report_.chunks;
  const auto records = uncompress(chunk->records, chunk->compression, chunk->uncompressed_size);
  const bool wrong_crc = records && chunk->crc != 0 && crc32_of(*records) != chunk->crc;
  if (!records || wrong_crc) {
    if (!knows_compression(chunk->compression)) {
      ++report_.unknown_chunks;
      damage(offset_, head_bytes + content.size(),
             fmt::format("the messages of a chunk are not read: {}", records.error().message));
      return Finding::damaged;
    }
    ++report_.lost_chunks;
    damage(offset_, head_bytes + content.size(),
           fmt::format("a chunk is damaged, its messages are lost: {}",
                       wrong_crc ? "its CRC is wrong" : records.error().message));
    return Finding::damaged;
  }
  report_.unchecked_chunks += chunk->crc == 0 ? 1 : 0;
  take_records(*records);
  return Finding::sound;
}

void Scan::take_records(std::string_view records) {
  std::size_t position = 0;
  while (position + head_bytes <= records.size()) {
    const auto opcode = static_cast<Opcode>(static_cast<std::uint8_t>(records[position]));
    const std::uint64_t length = number_at(records, position + 1, 8);
    if (length > records.size() - position - head_bytes) {
      break;
    }
    const std::string_view content = records.substr(position + head_bytes, length);
    if (opcode == Opcode::message) {
      take_message(content, position);
    } else if (auto channel = opcode == Opcode::channel ? parse_channel(content) : std::nullopt) {
      take_channel(std::move(*channel), true);
    } else if (opcode != Opcode::schema || take_definition(opcode, content) != Finding::sound) {
      damage(offset_, 0, fmt::format("a chunk holds a {} that is not read", name_of(opcode)));
    }
    position += head_bytes + length;
  }
  if (position != records.size()) {
    damage(offset_, 0, "the records of a chunk do not fit its length");
  }
}

void Scan::take_message(std::string_view content, std::uint64_t position) {
  const auto message = parse_message(content);
  const auto known = message ? channels_.find(message->channel_id) : channels_.end();
  if (known == channels_.end()) {
    damage(offset_, 0, "a message of a channel that is not there is lost");
    return;
  }
  ++report_.messages;
  const Channel& channel = known->second.channel;
  check_schema(channel);
  if (events_.message) {
    const auto schema = schemas_.find(channel.schema_id);
    events_.message({channel, schema == schemas_.end() ? nullptr : &schema->second, *message,
                     offset_, position});
  }
}

// The channel vouches for its schema, which stands outside chunks.
void Scan::check_schema(const Channel& channel) {
  if (!checked_.insert(channel.id).second || channel.schema_id == 0) {
    return;
  }
  const auto schema = schemas_.find(channel.schema_id);
  const auto crc = channel.metadata.find(schema_crc_key);
  const bool is_sound = schema != schemas_.end() && (crc == channel.metadata.end() ||
                                                     crc->second == schema_crc(schema->second));
  if (!is_sound) {
    damage(offset_, 0, fmt::format("the schema of topic '{}' is damaged", channel.topic));
  }
}

Expected<void> Scan::take_end(std::uint32_t crc, std::uint64_t begin) {
  if (crc != 0 && crc_ && *crc_ != crc && report_.damage_count == 0) {
    damage(0, begin, "something outside the chunks was changed: the CRC of the data is wrong");
  }
  DYNCAL_TRY(const auto ending, ending_behind(reader_, begin));
  report_.ended_in_order = ending == Ending::with_summary;
  if (ending == Ending::damaged) {
    damage(begin, reader_.size_bytes() - begin,
           "the summary at the end is damaged, no message is lost");
  }
  return {};
}

Expected<void> Scan::go_on_behind(std::uint64_t offset) {
  DYNCAL_TRY(const auto next,
             chunks_.next(offset + 1, [this](std::uint64_t from) { return walk_to(from); }));
  crc_.reset();
  offset_ = next.value_or(reader_.size_bytes());
  damage(offset, offset_ - offset,
         next ? "these bytes are no records: what stood here is lost"
              : "from here to the end there are no records: what stood here is lost");
  return {};
}

} // namespace dyncal::inline records::recording
