// The records of an MCAP file as bytes, and read from bytes (README.md has the format).
//
// Integers are little-endian without padding; times are nanoseconds since 1970 UTC. append_...()
// put a whole record, opcode and length first, behind a text. parse_...() read the content of one
// and give nothing when it does not fit its length; every length is held against the bytes there
// are before anything is taken. Views look at the bytes they were parsed from. Any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dyncal::inline records::recording {

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
  filler = 0x80 // of a private kind, which every reader skips: room for what comes (writer)
};

inline constexpr std::string_view magic{"\x89MCAP0\r\n", 8};
inline constexpr std::size_t head_bytes = 9; // opcode and length

using TextMap = std::map<std::string, std::string>;

struct Schema {
  std::uint16_t id = 0;
  std::string name;
  std::string encoding;
  std::string data;
  bool operator==(const Schema&) const = default;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0; // 0: none
  std::string topic;
  std::string message_encoding;
  TextMap metadata;
  bool operator==(const Channel&) const = default;
};

struct Message {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;
  std::uint64_t publish_time = 0;
  std::string_view data;
};

struct ChunkHead {
  std::uint64_t first_time = 0;
  std::uint64_t last_time = 0;
  std::uint64_t uncompressed_size = 0;
  std::uint32_t crc = 0; // of the records before compression; 0: none
  std::string compression;
  std::string_view records;
};

struct IndexEntry {
  std::uint64_t log_time = 0;
  std::uint64_t offset = 0; // of the message in the uncompressed records
};

struct ChunkIndex {
  std::uint64_t first_time = 0;
  std::uint64_t last_time = 0;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::map<std::uint16_t, std::uint64_t> message_indexes; // by channel: offset in the file
  std::uint64_t message_index_bytes = 0;
  std::string compression;
  std::uint64_t compressed_size = 0;
  std::uint64_t uncompressed_size = 0;
};

struct Attachment {
  std::uint64_t log_time = 0;
  std::string name;
  std::string media_type;
  std::string data;
};

struct Metadata {
  std::string name;
  TextMap entries;
};

// Where an attachment or metadata record lies.
struct Placed {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
};

struct Statistics {
  std::uint64_t messages = 0;
  std::uint16_t schemas = 0;
  std::uint32_t channels = 0;
  std::uint32_t attachments = 0;
  std::uint32_t metadata = 0;
  std::uint32_t chunks = 0;
  std::uint64_t first_time = 0;
  std::uint64_t last_time = 0;
  std::map<std::uint16_t, std::uint64_t> channel_messages;
};

struct Footer {
  std::uint64_t summary_start = 0; // 0: none
  std::uint64_t summary_offset_start = 0;
  std::uint32_t crc = 0; // of the summary and this record up to here; 0: none
};

// As zlib's: of `bytes` behind those of which `before` is the CRC.
[[nodiscard]] std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before = 0);
// Of a file part with CRC `before`, followed by `count` bytes with CRC `behind`.
[[nodiscard]] std::uint32_t joined_crc32(std::uint32_t before, std::uint32_t behind,
                                         std::uint64_t count);

void append_number(std::string& out, std::uint64_t value, std::size_t bytes);
// Opcode and length of a record whose content follows.
void append_head(std::string& out, Opcode opcode, std::uint64_t length);
void append_header(std::string& out, std::string_view library);
void append_schema(std::string& out, const Schema& schema);
void append_channel(std::string& out, const Channel& channel);
void append_message(std::string& out, const Message& message);
// The record up to its last field: `stored` bytes of records follow.
void append_chunk_head(std::string& out, const ChunkHead& chunk, std::uint64_t stored);
void append_message_index(std::string& out, std::uint16_t channel,
                          const std::vector<IndexEntry>& entries);
void append_chunk_index(std::string& out, const ChunkIndex& index);
void append_attachment(std::string& out, const Attachment& attachment);
void append_attachment_index(std::string& out, const Placed& place, const Attachment& attachment);
void append_metadata(std::string& out, const Metadata& metadata);
void append_metadata_index(std::string& out, const Placed& place, std::string_view name);
void append_statistics(std::string& out, const Statistics& statistics);
void append_summary_offset(std::string& out, Opcode group, const Placed& place);
void append_data_end(std::string& out, std::uint32_t crc);
void append_footer(std::string& out, const Footer& footer);

[[nodiscard]] std::uint64_t number_at(std::string_view bytes, std::size_t offset,
                                      std::size_t count);
[[nodiscard]] std::optional<std::string> parse_header(std::string_view content); // the library
[[nodiscard]] std::optional<Schema> parse_schema(std::string_view content);
[[nodiscard]] std::optional<Channel> parse_channel(std::string_view content);
[[nodiscard]] std::optional<Message> parse_message(std::string_view content);
[[nodiscard]] std::optional<ChunkHead> parse_chunk(std::string_view content);
[[nodiscard]] bool is_message_index(std::string_view content);
// Nothing if its CRC is wrong, too.
[[nodiscard]] std::optional<Attachment> parse_attachment(std::string_view content);
[[nodiscard]] std::optional<Metadata> parse_metadata(std::string_view content);
[[nodiscard]] std::optional<Footer> parse_footer(std::string_view content);

} // namespace dyncal::inline records::recording
