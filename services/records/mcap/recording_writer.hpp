// Writes an MCAP recording that is whole at every instant (recording_file.hpp).
//
// Schemas and channels stand outside chunks before the first chunk that has messages of theirs, so
// that a damaged chunk does not take the types with it. A chunk is followed by its message indexes;
// its CRC is that of its records before compression. close() adds the summary, by which other
// readers find a stretch of time without reading the whole file, and a CRC over all the data.
//
// Fails (bad_file) with file and reason. After a failure everything that was added before is in the
// file; close() may still be tried. One thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/records/mcap/chunk.hpp"
#include "services/records/mcap/chunk_codec.hpp"
#include "services/records/mcap/recording_file.hpp"

namespace dyncal::inline records::recording {

struct WriterOptions {
  std::string library; // name and version of the program
  std::vector<Schema> schemas;
  std::vector<Channel> channels;
  Compression compression = Compression::none;
};

class RecordingWriter {
public:
  [[nodiscard]] static base::Expected<RecordingWriter> create(const std::filesystem::path& path,
                                                              WriterOptions options);

  // With its own CRC as entry "crc32", for the format has none.
  [[nodiscard]] base::Expected<void> add_metadata(Metadata metadata);
  [[nodiscard]] base::Expected<void> add_attachment(const Attachment& attachment);
  // REQUIRES: messages, of channels of the options.
  [[nodiscard]] base::Expected<void> add_chunk(const Chunk& chunk);
  [[nodiscard]] base::Expected<void> synchronise() { return file_.synchronise(); }
  [[nodiscard]] base::Expected<void> close();

  [[nodiscard]] std::uint64_t messages() const { return statistics_.messages; }
  [[nodiscard]] std::uint64_t bytes() const { return file_.end(); }
  [[nodiscard]] std::uint64_t free_bytes() const { return file_.free_bytes(); }
  [[nodiscard]] const std::filesystem::path& path() const { return file_.path(); }

private:
  RecordingWriter(RecordingFile file, WriterOptions options)
      : file_(std::move(file)), options_(std::move(options)) {}
  [[nodiscard]] base::Expected<void> append(const std::string& record);
  [[nodiscard]] base::Expected<void> add_channels(const Chunk& chunk);
  void note_chunk(const Chunk& chunk, ChunkIndex index);
  [[nodiscard]] std::string ending() const;

  RecordingFile file_;
  WriterOptions options_;
  std::set<std::uint16_t> schemas_there_;
  std::set<std::uint16_t> channels_there_;
  Statistics statistics_;
  std::vector<ChunkIndex> chunks_;
  std::string attachment_indexes_;
  std::string metadata_indexes_;
};

} // namespace dyncal::inline records::recording
