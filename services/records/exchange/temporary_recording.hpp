// A recording that is put together from several files to be read
// like one: in a folder of its own below TMPDIR that is gone as soon as it is read.
//
// Fails (bad_file) with the reason, such as no room in TMPDIR. One thread.
#pragma once

#include <cstdint>
#include <filesystem>

#include "services/records/mcap/recording_reader.hpp"
#include "services/records/mcap/recording_writer.hpp"

namespace dyncal::inline records {

class TemporaryRecording {
public:
  [[nodiscard]] static Expected<TemporaryRecording> create(recording::WriterOptions options);
  TemporaryRecording(TemporaryRecording&& other) noexcept = default;
  TemporaryRecording& operator=(TemporaryRecording&&) = delete;
  ~TemporaryRecording();

  // Messages in the order in which they are added. REQUIRES: a channel of the options.
  [[nodiscard]] Expected<void> add(const recording::Channel& channel,
                                   const recording::Message& message);
  [[nodiscard]] Expected<void> add(const recording::Attachment& attachment);
  [[nodiscard]] Expected<void> add(recording::Metadata metadata);
  // The object is spent afterwards. `name`: for messages of the reader.
  [[nodiscard]] Expected<recording::RecordingReader> read(const std::filesystem::path& name);

private:
  TemporaryRecording(std::filesystem::path folder, recording::RecordingWriter writer)
      : folder_(std::move(folder)), writer_(std::move(writer)) {}
  [[nodiscard]] Expected<void> flush();

  std::filesystem::path folder_; // empty: moved from
  recording::RecordingWriter writer_;
  recording::Chunk chunk_;
};

} // namespace dyncal::inline records
