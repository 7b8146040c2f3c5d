#include "services/records/mcap/recording_writer.hpp"

#include <algorithm>
#include <array>

#include "services/records/mcap/text_crc.hpp"

namespace dyncal::inline records::recording {
namespace {

using base::Expected;

template <class Record>
const Record& by_id(const std::vector<Record>& records, std::uint16_t id) {
  return *std::ranges::find(records, id, &Record::id);
}

// The message indexes of a chunk whose record ends at `offset`.
std::string message_indexes(const Chunk& chunk, std::uint64_t offset, ChunkIndex& index) {
  std::string records;
  for (const auto& [channel, entries] : chunk.index()) {
    index.message_indexes[channel] = offset + records.size();
    append_message_index(records, channel, entries);
  }
  index.message_index_bytes = records.size();
  return records;
}

// Appends a group of the summary, and where it is.
class Summary {
public:
  explicit Summary(std::uint64_t offset) : offset_(offset) {}

  void add(Opcode group, const std::string& records) {
    if (!records.empty()) {
      append_summary_offset(offsets_, group, {offset_ + records_.size(), records.size()});
      records_ += records;
    }
  }
  // With Footer and magic.
  [[nodiscard]] std::string finished() const {
    std::string text = records_ + offsets_;
    append_footer(text, {offset_, offset_ + records_.size(), 0});
    text.resize(text.size() - 4);
    append_number(text, crc32_of(text), 4);
    return text + std::string(magic);
  }

private:
  std::uint64_t offset_;
  std::string records_;
  std::string offsets_;
};

} // namespace

Expected<RecordingWriter> RecordingWriter::create(const std::filesystem::path& path,
                                                  WriterOptions options) {
  std::string beginning(magic);
  append_header(beginning, options.library);
  DYNCAL_TRY(auto file, RecordingFile::create(path, beginning));
  return RecordingWriter(std::move(file), std::move(options));
}

Expected<void> RecordingWriter::append(const std::string& record) {
  const std::array<std::string_view, 1> parts{record};
  return file_.append(parts, crc32_of(record));
}

Expected<void> RecordingWriter::add_metadata(Metadata metadata) {
  metadata.entries[metadata_crc_key] = metadata_crc(metadata);
  std::string record;
  append_metadata(record, metadata);
  const std::uint64_t offset = file_.end();
  return append(record).map([&] {
    append_metadata_index(metadata_indexes_, {offset, record.size()}, metadata.name);
    ++statistics_.metadata;
  });
}

Expected<void> RecordingWriter::add_attachment(const Attachment& attachment) {
  std::string record;
  append_attachment(record, attachment);
  const std::uint64_t offset = file_.end();
  return append(record).map([&] {
    append_attachment_index(attachment_indexes_, {offset, record.size()}, attachment);
    ++statistics_.attachments;
  });
}

Expected<void> RecordingWriter::add_channels(const Chunk& chunk) {
  for (const auto& [id, entries] : chunk.index()) {
    if (channels_there_.contains(id)) {
      continue;
    }
    const Channel& channel = by_id(options_.channels, id);
    std::string records;
    const bool new_schema = channel.schema_id != 0 && !schemas_there_.contains(channel.schema_id);
    if (new_schema) {
      append_schema(records, by_id(options_.schemas, channel.schema_id));
    }
    append_channel(records, channel);
    DYNCAL_TRY(append(records));
    channels_there_.insert(id);
    if (new_schema) {
      schemas_there_.insert(channel.schema_id);
    }
  }
  return {};
}

Expected<void> RecordingWriter::add_chunk(const Chunk& chunk) {
  DYNCAL_TRY(add_channels(chunk));
  const std::string& records = chunk.records();
  const std::string smaller = compress(records, options_.compression);
  const std::string_view stored = smaller.empty() ? records : smaller;
  ChunkHead head;
  head.first_time = chunk.first_time();
  head.last_time = chunk.last_time();
  head.uncompressed_size = records.size();
  head.crc = chunk.crc();
  head.compression = smaller.empty() ? "" : to_string(options_.compression);
  std::string begin;
  append_chunk_head(begin, head, stored.size());
  ChunkIndex index;
  index.first_time = head.first_time;
  index.last_time = head.last_time;
  index.offset = file_.end();
  index.length = begin.size() + stored.size();
  index.compression = head.compression;
  index.compressed_size = stored.size();
  index.uncompressed_size = records.size();
  const std::string indexes = message_indexes(chunk, index.offset + index.length, index);
  const std::uint32_t crc_stored = smaller.empty() ? head.crc : crc32_of(smaller);
  const std::uint32_t crc =
      crc32_of(indexes, joined_crc32(crc32_of(begin), crc_stored, stored.size()));
  const std::array<std::string_view, 3> parts{begin, stored, indexes};
  return file_.append(parts, crc).map([&] { note_chunk(chunk, std::move(index)); });
}

void RecordingWriter::note_chunk(const Chunk& chunk, ChunkIndex index) {
  chunks_.push_back(std::move(index));
  statistics_.first_time = statistics_.messages == 0
                               ? chunk.first_time()
                               : std::min(statistics_.first_time, chunk.first_time());
  statistics_.last_time = std::max(statistics_.last_time, chunk.last_time());
  statistics_.messages += chunk.messages();
  ++statistics_.chunks;
  for (const auto& [channel, entries] : chunk.index()) {
    statistics_.channel_messages[channel] += entries.size();
  }
}

std::string RecordingWriter::ending() const {
  std::string end;
  append_data_end(end, file_.crc());
  Summary summary(file_.end() + end.size());
  std::string schemas;
  for (const std::uint16_t id : schemas_there_) {
    append_schema(schemas, by_id(options_.schemas, id));
  }
  summary.add(Opcode::schema, schemas);
  std::string channels;
  for (const std::uint16_t id : channels_there_) {
    append_channel(channels, by_id(options_.channels, id));
  }
  summary.add(Opcode::channel, channels);
  Statistics statistics = statistics_;
  statistics.schemas = static_cast<std::uint16_t>(schemas_there_.size());
  statistics.channels = static_cast<std::uint32_t>(channels_there_.size());
  std::string counts;
  append_statistics(counts, statistics);
  summary.add(Opcode::statistics, counts);
  std::string indexes;
  for (const ChunkIndex& chunk : chunks_) {
    append_chunk_index(indexes, chunk);
  }
  summary.add(Opcode::chunk_index, indexes);
  summary.add(Opcode::attachment_index, attachment_indexes_);
  summary.add(Opcode::metadata_index, metadata_indexes_);
  return end + summary.finished();
}

Expected<void> RecordingWriter::close() {
  return file_.finish(ending());
}

} // namespace dyncal::inline records::recording
