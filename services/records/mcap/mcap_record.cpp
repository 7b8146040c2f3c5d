#include "services/records/mcap/mcap_record.hpp"

#include <concepts>
#include <type_traits>
#include <zlib.h>

namespace dyncal::inline records::recording {
namespace {

template <class T, class Record>
concept Either = std::same_as<std::remove_const_t<T>, Record>;

// The fields of a record in their order, each named once, for Fields and for put().
void fields(auto& io, Either<Schema> auto& one) {
  io(one.id, one.name, one.encoding, one.data);
}
void fields(auto& io, Either<Channel> auto& one) {
  io(one.id, one.schema_id, one.topic, one.message_encoding, one.metadata);
}
// Without the data, which reach to its end.
void fields(auto& io, Either<Message> auto& one) {
  io(one.channel_id, one.sequence, one.log_time, one.publish_time);
}
// Without the records, which their size stands before.
void fields(auto& io, Either<ChunkHead> auto& one) {
  io(one.first_time, one.last_time, one.uncompressed_size, one.crc, one.compression);
}
void fields(auto& io, Either<ChunkIndex> auto& one) {
  io(one.first_time, one.last_time, one.offset, one.length, one.message_indexes,
     one.message_index_bytes, one.compression, one.compressed_size, one.uncompressed_size);
}
void fields(auto& io, Either<Metadata> auto& one) {
  io(one.name, one.entries);
}
void fields(auto& io, Either<Statistics> auto& one) {
  io(one.messages, one.schemas, one.channels, one.attachments, one.metadata, one.chunks,
     one.first_time, one.last_time, one.channel_messages);
}
void fields(auto& io, Either<Footer> auto& one) {
  io(one.summary_start, one.summary_offset_start, one.crc);
}

template <std::unsigned_integral Number>
void put(std::string& out, Number value) {
  append_number(out, value, sizeof(value));
}
void put(std::string& out, std::string_view text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

// Puts how many bytes `write` appends before them.
template <std::unsigned_integral Size, class Write>
void put_sized(std::string& out, Write write) {
  const std::size_t begin = out.size();
  put(out, Size{0});
  write();
  const std::uint64_t size = out.size() - begin - sizeof(Size);
  for (std::size_t byte = 0; byte < sizeof(Size); ++byte) {
    out[begin + byte] = static_cast<char>(size >> (8 * byte));
  }
}

template <class Key, class Value>
void put(std::string& out, const std::map<Key, Value>& entries) {
  put_sized<std::uint32_t>(out, [&] {
    for (const auto& [key, value] : entries) {
      put(out, key);
      put(out, value);
    }
  });
}

// Appends a record of these fields.
void append_record(std::string& out, Opcode opcode, const auto&... values) {
  out.push_back(static_cast<char>(opcode));
  put_sized<std::uint64_t>(out, [&] { (put(out, values), ...); });
}

template <class Record>
void append_fields_of(std::string& out, Opcode opcode, const Record& record) {
  const auto append = [&](const auto&... values) { append_record(out, opcode, values...); };
  fields(append, record);
}

// Takes fields from the front of a content; fails for good at the first that does not fit.
class Fields {
public:
  explicit Fields(std::string_view bytes) : bytes_(bytes) {}

  void operator()(auto&... fields) { (take(fields), ...); }
  template <std::unsigned_integral Number>
  Number number() {
    Number value = 0;
    take(value);
    return value;
  }
  std::string_view view(std::uint64_t count) {
    if (!fits_ || count > bytes_.size()) {
      fits_ = false;
      return {};
    }
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  std::string_view rest() { return view(bytes_.size()); }
  [[nodiscard]] bool fits() const { return fits_; }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }

private:
  template <std::unsigned_integral Number>
  void take(Number& value) {
    const std::string_view bytes = view(sizeof(Number));
    value = static_cast<Number>(fits_ ? number_at(bytes, 0, sizeof(Number)) : 0);
  }
  void take(std::string& text) { text = view(number<std::uint32_t>()); }
  void take(TextMap& map) {
    Fields entries(view(number<std::uint32_t>()));
    while (entries.fits() && !entries.at_end()) {
      std::string key;
      entries(key);
      entries.take(map[key]);
    }
    fits_ = fits_ && entries.fits();
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

template <class Record>
std::optional<Record> parse(std::string_view content) {
  Fields from(content);
  Record record;
  fields(from, record);
  return if_fits(from, std::move(record));
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
  put(out, length);
}

void append_header(std::string& out, std::string_view library) {
  constexpr std::string_view profile;
  append_record(out, Opcode::header, profile, library);
}

void append_schema(std::string& out, const Schema& schema) {
  append_fields_of(out, Opcode::schema, schema);
}

void append_channel(std::string& out, const Channel& channel) {
  append_fields_of(out, Opcode::channel, channel);
}

void append_message(std::string& out, const Message& message) {
  append_head(out, Opcode::message, 22 + message.data.size());
  const auto append = [&](const auto&... values) { (put(out, values), ...); };
  fields(append, message);
  out += message.data;
}

void append_chunk_head(std::string& out, const ChunkHead& chunk, std::uint64_t stored) {
  append_head(out, Opcode::chunk, 40 + chunk.compression.size() + stored);
  const auto append = [&](const auto&... values) { (put(out, values), ...); };
  fields(append, chunk);
  put(out, stored);
}

void append_message_index(std::string& out, std::uint16_t channel,
                          const std::vector<IndexEntry>& entries) {
  append_head(out, Opcode::message_index, 6 + 16 * entries.size());
  put(out, channel);
  put(out, static_cast<std::uint32_t>(16 * entries.size()));
  for (const IndexEntry& entry : entries) {
    put(out, entry.log_time);
    put(out, entry.offset);
  }
}

void append_chunk_index(std::string& out, const ChunkIndex& index) {
  append_fields_of(out, Opcode::chunk_index, index);
}

void append_attachment(std::string& out, const Attachment& one) {
  append_head(out, Opcode::attachment,
              36 + one.name.size() + one.media_type.size() + one.data.size());
  const std::size_t begin = out.size();
  put(out, one.log_time);
  put(out, one.log_time); // when it was made
  put(out, one.name);
  put(out, one.media_type);
  put(out, std::uint64_t{one.data.size()});
  out += one.data;
  put(out, crc32_of(std::string_view(out).substr(begin)));
}

void append_attachment_index(std::string& out, const Placed& place, const Attachment& one) {
  append_record(out, Opcode::attachment_index, place.offset, place.length, one.log_time,
                one.log_time, std::uint64_t{one.data.size()}, one.name, one.media_type);
}

void append_metadata(std::string& out, const Metadata& metadata) {
  append_fields_of(out, Opcode::metadata, metadata);
}

void append_metadata_index(std::string& out, const Placed& place, std::string_view name) {
  append_record(out, Opcode::metadata_index, place.offset, place.length, name);
}

void append_statistics(std::string& out, const Statistics& statistics) {
  append_fields_of(out, Opcode::statistics, statistics);
}

void append_summary_offset(std::string& out, Opcode group, const Placed& place) {
  append_record(out, Opcode::summary_offset, static_cast<std::uint8_t>(group), place.offset,
                place.length);
}

void append_data_end(std::string& out, std::uint32_t crc) {
  append_record(out, Opcode::data_end, crc);
}

void append_footer(std::string& out, const Footer& footer) {
  append_fields_of(out, Opcode::footer, footer);
}

std::uint64_t number_at(std::string_view bytes, std::size_t offset, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t byte = 0; byte < count; ++byte) {
    value |= std::uint64_t{static_cast<std::uint8_t>(bytes[offset + byte])} << (8 * byte);
  }
  return value;
}

std::optional<std::string> parse_header(std::string_view content) {
  Fields from(content);
  std::string profile;
  std::string library;
  from(profile, library);
  return if_fits(from, std::move(library));
}

std::optional<Schema> parse_schema(std::string_view content) {
  auto schema = parse<Schema>(content);
  return schema && schema->id != 0 ? std::move(schema) : std::nullopt;
}

std::optional<Channel> parse_channel(std::string_view content) {
  return parse<Channel>(content);
}

std::optional<Message> parse_message(std::string_view content) {
  Fields from(content);
  Message message;
  fields(from, message);
  message.data = from.rest();
  return if_fits(from, message);
}

std::optional<ChunkHead> parse_chunk(std::string_view content) {
  Fields from(content);
  ChunkHead chunk;
  fields(from, chunk);
  chunk.records = from.view(from.number<std::uint64_t>());
  return if_fits(from, std::move(chunk));
}

bool is_message_index(std::string_view content) {
  Fields from(content);
  from.number<std::uint16_t>();
  const auto bytes = from.number<std::uint32_t>();
  from.view(bytes);
  return from.fits() && from.at_end() && bytes % 16 == 0;
}

std::optional<Attachment> parse_attachment(std::string_view content) {
  Fields from(content);
  Attachment one;
  std::uint64_t made = 0;
  from(one.log_time, made, one.name, one.media_type);
  one.data = std::string(from.view(from.number<std::uint64_t>()));
  const auto crc = from.number<std::uint32_t>();
  const bool sound = from.fits() && from.at_end() &&
                     (crc == 0 || crc == crc32_of(content.substr(0, content.size() - 4)));
  return sound ? std::optional(std::move(one)) : std::nullopt;
}

std::optional<Metadata> parse_metadata(std::string_view content) {
  return parse<Metadata>(content);
}

std::optional<Footer> parse_footer(std::string_view content) {
  return parse<Footer>(content);
}

} // namespace dyncal::inline records::recording
