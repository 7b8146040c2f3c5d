#include "services/records/mcap/mcap_record.hpp"

#include <limits>

#include <zlib.h>

namespace dyncal::inline records::recording {
namespace {

void append_text(std::string& out, std::string_view text) {
  append_number(out, text.size(), 4);
  out += text;
}

// Appends a record whose content `write` puts behind its head.
template <class Write>
void append_record(std::string& out, Opcode opcode, Write write) {
  const std::size_t begin = out.size();
  append_head(out, opcode, 0);
  write();
  const std::uint64_t length = out.size() - begin - head_bytes;
  for (std::size_t byte = 0; byte < 8; ++byte) {
    out[begin + 1 + byte] = static_cast<char>(length >> (8 * byte));
  }
}

// Writes what `write` appends, its number of bytes first.
template <class Write>
void append_sized(std::string& out, Write write) {
  const std::size_t begin = out.size();
  append_number(out, 0, 4);
  write();
  const std::uint64_t size = out.size() - begin - 4;
  for (std::size_t byte = 0; byte < 4; ++byte) {
    out[begin + byte] = static_cast<char>(size >> (8 * byte));
  }
}

void append_text_map(std::string& out, const TextMap& entries) {
  append_sized(out, [&] {
    for (const auto& [key, value] : entries) {
      append_text(out, key);
      append_text(out, value);
    }
  });
}

void append_count_map(std::string& out, const std::map<std::uint16_t, std::uint64_t>& entries) {
  append_sized(out, [&] {
    for (const auto& [key, value] : entries) {
      append_number(out, key, 2);
      append_number(out, value, 8);
    }
  });
}

// Takes fields from the front of a content; fails for good at the first that does not fit.
class Fields {
public:
  explicit Fields(std::string_view bytes) : bytes_(bytes) {}

  template <class Number>
  Number number() {
    const std::string_view bytes = take(sizeof(Number));
    return static_cast<Number>(fits_ ? number_at(bytes, 0, sizeof(Number)) : 0);
  }
  std::string_view view(std::uint64_t count) { return take(count); }
  std::string_view rest() { return take(bytes_.size()); }
  std::string text() { return std::string(take(number<std::uint32_t>())); }
  TextMap text_map() {
    Fields entries(take(number<std::uint32_t>()));
    TextMap map;
    while (entries.fits() && !entries.at_end()) {
      std::string key = entries.text();
      map[std::move(key)] = entries.text();
    }
    fits_ = fits_ && entries.fits();
    return map;
  }
  [[nodiscard]] bool fits() const { return fits_; }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }

private:
  std::string_view take(std::uint64_t count) {
    if (!fits_ || count > bytes_.size()) {
      fits_ = false;
      return {};
    }
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }

  std::string_view bytes_;
  bool fits_ = true;
};

// A content with more than its fields is not taken either: no version of the format has more, and a
// length that is wrong must not go unnoticed.
template <class Record>
std::optional<Record> if_fits(const Fields& fields, Record record) {
  return fields.fits() && fields.at_end() ? std::optional(std::move(record)) : std::nullopt;
}

} // namespace

std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::uint32_t joined_crc32(std::uint32_t before, std::uint32_t behind, std::uint64_t count) {
  return static_cast<std::uint32_t>(crc32_combine(before, behind, static_cast<z_off_t>(count)));
}

void append_number(std::string& out, std::uint64_t value, std::size_t bytes) {
  for (std::size_t byte = 0; byte < bytes; ++byte) {
    out.push_back(static_cast<char>(value >> (8 * byte)));
  }
}

void append_head(std::string& out, Opcode opcode, std::uint64_t length) {
  out.push_back(static_cast<char>(opcode));
  append_number(out, length, 8);
}

void append_header(std::string& out, std::string_view library) {
  append_record(out, Opcode::header, [&] {
    append_text(out, ""); // profile
    append_text(out, library);
  });
}

void append_schema(std::string& out, const Schema& schema) {
  append_record(out, Opcode::schema, [&] {
    append_number(out, schema.id, 2);
    append_text(out, schema.name);
    append_text(out, schema.encoding);
    append_text(out, schema.data);
  });
}

void append_channel(std::string& out, const Channel& channel) {
  append_record(out, Opcode::channel, [&] {
    append_number(out, channel.id, 2);
    append_number(out, channel.schema_id, 2);
    append_text(out, channel.topic);
    append_text(out, channel.message_encoding);
    append_text_map(out, channel.metadata);
  });
}

void append_message(std::string& out, const Message& message) {
  append_head(out, Opcode::message, 22 + message.data.size());
  append_number(out, message.channel_id, 2);
  append_number(out, message.sequence, 4);
  append_number(out, message.log_time, 8);
  append_number(out, message.publish_time, 8);
  out += message.data;
}

void append_chunk_head(std::string& out, const ChunkHead& chunk, std::uint64_t stored) {
  append_head(out, Opcode::chunk, 40 + chunk.compression.size() + stored);
  append_number(out, chunk.first_time, 8);
  append_number(out, chunk.last_time, 8);
  append_number(out, chunk.uncompressed_size, 8);
  append_number(out, chunk.crc, 4);
  append_text(out, chunk.compression);
  append_number(out, stored, 8);
}

void append_message_index(std::string& out, std::uint16_t channel,
                          const std::vector<IndexEntry>& entries) {
  append_record(out, Opcode::message_index, [&] {
    append_number(out, channel, 2);
    append_sized(out, [&] {
      for (const IndexEntry& entry : entries) {
        append_number(out, entry.log_time, 8);
        append_number(out, entry.offset, 8);
      }
    });
  });
}

void append_chunk_index(std::string& out, const ChunkIndex& index) {
  append_record(out, Opcode::chunk_index, [&] {
    append_number(out, index.first_time, 8);
    append_number(out, index.last_time, 8);
    append_number(out, index.offset, 8);
    append_number(out, index.length, 8);
    append_count_map(out, index.message_indexes);
    append_number(out, index.message_index_bytes, 8);
    append_text(out, index.compression);
    append_number(out, index.compressed_size, 8);
    append_number(out, index.uncompressed_size, 8);
  });
}

void append_attachment(std::string& out, const Attachment& attachment) {
  append_record(out, Opcode::attachment, [&] {
    const std::size_t begin = out.size();
    append_number(out, attachment.log_time, 8);
    append_number(out, attachment.log_time, 8);
    append_text(out, attachment.name);
    append_text(out, attachment.media_type);
    append_number(out, attachment.data.size(), 8);
    out += attachment.data;
    append_number(out, crc32_of(std::string_view(out).substr(begin)), 4);
  });
}

void append_attachment_index(std::string& out, const Placed& place, const Attachment& attachment) {
  append_record(out, Opcode::attachment_index, [&] {
    append_number(out, place.offset, 8);
    append_number(out, place.length, 8);
    append_number(out, attachment.log_time, 8);
    append_number(out, attachment.log_time, 8);
    append_number(out, attachment.data.size(), 8);
    append_text(out, attachment.name);
    append_text(out, attachment.media_type);
  });
}

void append_metadata(std::string& out, const Metadata& metadata) {
  append_record(out, Opcode::metadata, [&] {
    append_text(out, metadata.name);
    append_text_map(out, metadata.entries);
  });
}

void append_metadata_index(std::string& out, const Placed& place, std::string_view name) {
  append_record(out, Opcode::metadata_index, [&] {
    append_number(out, place.offset, 8);
    append_number(out, place.length, 8);
    append_text(out, name);
  });
}

void append_statistics(std::string& out, const Statistics& statistics) {
  append_record(out, Opcode::statistics, [&] {
    append_number(out, statistics.messages, 8);
    append_number(out, statistics.schemas, 2);
    append_number(out, statistics.channels, 4);
    append_number(out, statistics.attachments, 4);
    append_number(out, statistics.metadata, 4);
    append_number(out, statistics.chunks, 4);
    append_number(out, statistics.first_time, 8);
    append_number(out, statistics.last_time, 8);
    append_count_map(out, statistics.channel_messages);
  });
}

void append_summary_offset(std::string& out, Opcode group, const Placed& place) {
  append_record(out, Opcode::summary_offset, [&] {
    append_number(out, static_cast<std::uint8_t>(group), 1);
    append_number(out, place.offset, 8);
    append_number(out, place.length, 8);
  });
}

void append_data_end(std::string& out, std::uint32_t crc) {
  append_record(out, Opcode::data_end, [&] { append_number(out, crc, 4); });
}

void append_footer(std::string& out, const Footer& footer) {
  append_record(out, Opcode::footer, [&] {
    append_number(out, footer.summary_start, 8);
    append_number(out, footer.summary_offset_start, 8);
    append_number(out, footer.crc, 4);
  });
}

std::uint64_t number_at(std::string_view bytes, std::size_t offset, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t byte = 0; byte < count; ++byte) {
    value |= std::uint64_t{static_cast<std::uint8_t>(bytes[offset + byte])} << (8 * byte);
  }
  return value;
}

std::optional<std::string> parse_header(std::string_view content) {
  Fields fields(content);
  fields.text(); // profile
  std::string library = fields.text();
  return if_fits(fields, std::move(library));
}

std::optional<Schema> parse_schema(std::string_view content) {
  Fields fields(content);
  Schema schema;
  schema.id = fields.number<std::uint16_t>();
  schema.name = fields.text();
  schema.encoding = fields.text();
  schema.data = fields.text();
  return schema.id == 0 ? std::nullopt : if_fits(fields, std::move(schema));
}

std::optional<Channel> parse_channel(std::string_view content) {
  Fields fields(content);
  Channel channel;
  channel.id = fields.number<std::uint16_t>();
  channel.schema_id = fields.number<std::uint16_t>();
  channel.topic = fields.text();
  channel.message_encoding = fields.text();
  channel.metadata = fields.text_map();
  return if_fits(fields, std::move(channel));
}

std::optional<Message> parse_message(std::string_view content) {
  Fields fields(content);
  Message message;
  message.channel_id = fields.number<std::uint16_t>();
  message.sequence = fields.number<std::uint32_t>();
  message.log_time = fields.number<std::uint64_t>();
  message.publish_time = fields.number<std::uint64_t>();
  message.data = fields.rest();
  return if_fits(fields, message);
}

std::optional<ChunkHead> parse_chunk(std::string_view content) {
  Fields fields(content);
  ChunkHead chunk;
  chunk.first_time = fields.number<std::uint64_t>();
  chunk.last_time = fields.number<std::uint64_t>();
  chunk.uncompressed_size = fields.number<std::uint64_t>();
  chunk.crc = fields.number<std::uint32_t>();
  chunk.compression = fields.text();
  chunk.records = fields.view(fields.number<std::uint64_t>());
  return if_fits(fields, std::move(chunk));
}

bool is_message_index(std::string_view content) {
  Fields fields(content);
  fields.number<std::uint16_t>();
  const auto bytes = fields.number<std::uint32_t>();
  fields.view(bytes);
  return fields.fits() && fields.at_end() && bytes % 16 == 0;
}

std::optional<Attachment> parse_attachment(std::string_view content) {
  Fields fields(content);
  Attachment attachment;
  attachment.log_time = fields.number<std::uint64_t>();
  fields.number<std::uint64_t>(); // when it was made
  attachment.name = fields.text();
  attachment.media_type = fields.text();
  attachment.data = std::string(fields.view(fields.number<std::uint64_t>()));
  const auto crc = fields.number<std::uint32_t>();
  const bool sound = fields.fits() && fields.at_end() &&
                     (crc == 0 || crc == crc32_of(content.substr(0, content.size() - 4)));
  return sound ? std::optional(std::move(attachment)) : std::nullopt;
}

std::optional<Metadata> parse_metadata(std::string_view content) {
  Fields fields(content);
  Metadata metadata;
  metadata.name = fields.text();
  metadata.entries = fields.text_map();
  return if_fits(fields, std::move(metadata));
}

std::optional<Footer> parse_footer(std::string_view content) {
  Fields fields(content);
  Footer footer;
  footer.summary_start = fields.number<std::uint64_t>();
  footer.summary_offset_start = fields.number<std::uint64_t>();
  footer.crc = fields.number<std::uint32_t>();
  return if_fits(fields, footer);
}

} // namespace dyncal::inline records::recording
