#include "services/records/mcap/repair.hpp"

#include <map>

#include <fmt/core.h>

#include "services/base/byte_count.hpp"
#include "services/base/output_stream.hpp"
#include "services/records/mcap/recording_writer.hpp"

namespace dyncal::inline records::recording {
namespace {

using base::Expected;

// The schemas and channels that messages need; of a channel that was changed in the file, the one
// that stands in chunks.
class Definitions {
public:
  void add(const MessageInFile& message) {
    channels_.insert_or_assign(message.channel.id, message.channel);
    if (message.schema != nullptr) {
      schemas_.insert_or_assign(message.schema->id, *message.schema);
    } else {
      channels_.at(message.channel.id).schema_id = 0;
    }
  }
  [[nodiscard]] WriterOptions options(const std::string& library) const {
    WriterOptions options;
    options.library = library;
    for (const auto& [id, schema] : schemas_) {
      options.schemas.push_back(schema);
    }
    for (const auto& [id, channel] : channels_) {
      options.channels.push_back(channel);
    }
    return options;
  }
  [[nodiscard]] const Channel& channel(std::uint16_t id) const { return channels_.at(id); }

private:
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
};

// Copies what a second walk through the old file finds.
class Copy {
public:
  Copy(RecordingWriter& writer, const Definitions& definitions)
      : writer_(writer), definitions_(definitions) {}

  void add(const MessageInFile& message) {
    if (message.chunk != chunk_of_) {
      flush();
      chunk_of_ = message.chunk;
    }
    chunk_.add(definitions_.channel(message.channel.id), message.message);
  }
  void add(const Attachment& attachment) { note(writer_.add_attachment(attachment)); }
  void add(const Metadata& metadata) { note(writer_.add_metadata(metadata)); }
  void flush() {
    if (!chunk_.empty()) {
      note(writer_.add_chunk(chunk_));
      chunk_ = {};
    }
  }
  [[nodiscard]] const Expected<void>& outcome() const { return outcome_; }

private:
  void note(Expected<void> outcome) {
    if (outcome_) {
      outcome_ = std::move(outcome);
    }
  }

  RecordingWriter& writer_;
  const Definitions& definitions_;
  Chunk chunk_;
  std::uint64_t chunk_of_ = 0;
  Expected<void> outcome_;
};

Metadata repair_metadata(const std::filesystem::path& path, const ScanReport& report) {
  Metadata metadata{"dyncal.repair",
                    {{"file", path.filename().string()},
                     {"library", report.library},
                     {"damages", fmt::format("{}", report.damage_count)},
                     {"lost_chunks", fmt::format("{}", report.lost_chunks)}}};
  for (std::size_t i = 0; i < report.damages.size(); ++i) {
    metadata.entries[fmt::format("damage {:04}", i + 1)] =
        to_string(report.damages[i], path.filename());
  }
  return metadata;
}

// NAME.part, until all of it is there; without that nothing is left.
class Unfinished {
public:
  explicit Unfinished(const std::filesystem::path& path)
      : path_(path), unfinished_(path.string() + ".part") {
    remove(); // of a repair that was interrupted
  }
  ~Unfinished() { remove(); }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return unfinished_; }
  [[nodiscard]] Expected<void> finish() const { return base::take_output_name(unfinished_, path_); }

private:
  void remove() const {
    std::error_code ignored;
    std::filesystem::remove(unfinished_, ignored);
  }

  std::filesystem::path path_;
  std::filesystem::path unfinished_;
};

} // namespace

Expected<ScanReport> repair(const std::filesystem::path& path,
                            const std::filesystem::path& repaired, const std::string& library,
                            const base::SharedWorkCount& count) {
  DYNCAL_TRY(auto reader, RecordingReader::open(path));
  DYNCAL_TRY(base::check_new_output(repaired));
  base::ByteCount read(count, "reading", reader.size_bytes());
  Definitions definitions;
  auto report =
      reader.scan({.message = [&](const MessageInFile& message) { definitions.add(message); },
                   .walked =
                       [&](std::uint64_t bytes) {
                         read.set_done(bytes);
                         return true;
                       }});
  if (!report) {
    return report;
  }
  const Unfinished file(repaired);
  DYNCAL_TRY(auto writer, RecordingWriter::create(file.path(), definitions.options(library)));
  Copy copy(writer, definitions);
  base::ByteCount copied_bytes(count, "copying", reader.size_bytes());
  const auto copied =
      reader.scan({.message = [&](const MessageInFile& message) { copy.add(message); },
                   .attachment = [&](const Attachment& attachment) { copy.add(attachment); },
                   .metadata = [&](const Metadata& metadata) { copy.add(metadata); },
                   .walked =
                       [&](std::uint64_t bytes) {
                         copied_bytes.set_done(bytes);
                         return true;
                       }});
  copy.flush();
  DYNCAL_TRY(copied);
  auto written = copy.outcome()
                     .and_then([&] { return writer.add_metadata(repair_metadata(path, *report)); })
                     .and_then([&] { return writer.close(); })
                     .and_then([&] { return file.finish(); });
  DYNCAL_TRY(written);
  return report;
}

} // namespace dyncal::inline records::recording
