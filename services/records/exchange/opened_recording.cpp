#include "services/records/exchange/opened_recording.hpp"

#include <fmt/core.h>

#include "services/base/byte_count.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/records/capture/recorded_topics.hpp"
#include "services/records/exchange/temporary_recording.hpp"

namespace dyncal::inline records {
namespace {

// recording.mcap, recording-2.mcap, ... as far as they are there.
std::vector<std::filesystem::path> recordings_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (std::filesystem::path next = folder / recording_file_name; std::filesystem::exists(next);
       next = folder / fmt::format("recording-{}.mcap", files.size() + 1)) {
    files.push_back(next);
  }
  return files;
}

// Everything of one file, behind what is there already.
Expected<void> append(const std::filesystem::path& path, TemporaryRecording& joined,
                      std::vector<std::string>& warnings, ByteCount& bytes,
                      const std::stop_token& stop) {
  DYNCAL_TRY(auto reader, recording::RecordingReader::open(path));
  Expected<void> added;
  const auto note = [&](Expected<void> outcome) {
    if (added) {
      added = std::move(outcome);
    }
  };
  const auto& channels = recording::recorded_channels();
  const std::uint64_t before = bytes.done();
  const auto report =
      reader.scan({.message =
                       [&](const recording::MessageInFile& message) {
                         for (const recording::Channel& channel : channels) {
                           if (channel.topic == message.channel.topic) {
                             recording::Message one = message.message;
                             one.channel_id = channel.id;
                             note(joined.add(channel, one));
                           }
                         }
                       },
                   .attachment = [&](const recording::Attachment& one) { note(joined.add(one)); },
                   .metadata = [&](const recording::Metadata& one) { note(joined.add(one)); },
                   .walked =
                       [&](std::uint64_t walked) {
                         bytes.set_done(before + walked);
                         return !stop.stop_requested();
                       }});
  DYNCAL_TRY(report);
  for (const recording::Damage& damage : report->damages) {
    warnings.push_back(to_string(damage, path));
  }
  return added;
}

Expected<OpenedRecording> join(const std::filesystem::path& folder,
                               const std::vector<std::filesystem::path>& files,
                               const SharedWorkCount& count, const std::stop_token& stop) {
  recording::WriterOptions options;
  options.library = fmt::format("{} recordings of a run", files.size());
  options.schemas = recording::recorded_schemas();
  options.channels = recording::recorded_channels();
  DYNCAL_TRY(auto joined, TemporaryRecording::create(std::move(options)));
  std::vector<std::string> warnings;
  ByteCount bytes(count, "reading", bytes_of_files(files));
  for (const auto& file : files) {
    DYNCAL_TRY(append(file, joined, warnings, bytes, stop));
  }
  return joined.read(folder).map([&](recording::RecordingReader reader) {
    return OpenedRecording{std::move(reader), std::move(warnings)};
  });
}

} // namespace

bool is_recording(const std::filesystem::path& path) {
  return path.extension() == ".mcap" || std::filesystem::exists(path / recording_file_name);
}

Expected<OpenedRecording> open_recording(const std::filesystem::path& path,
                                         const SharedWorkCount& count,
                                         const std::stop_token& stop) {
  const auto files = recordings_in(path);
  if (files.size() > 1) {
    return join(path, files, count, stop);
  }
  return recording::RecordingReader::open(files.empty() ? path : files.front())
      .map([](recording::RecordingReader reader) {
        return OpenedRecording{std::move(reader), {}};
      });
}

} // namespace dyncal::inline records
