#include "services/records/exchange/opened_recording.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>

#include <fmt/core.h>

#include "services/base/byte_count.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/records/capture/recorded_topics.hpp"
#include "services/records/mcap/recording_writer.hpp"

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

constexpr std::size_t chunk_bytes = std::size_t{1} << 20U;

// Several recordings as one, to be read like a file: in a folder of its own below TMPDIR that is
// gone as soon as it is read. Fails (bad_file) with the reason, such as no room in TMPDIR.
class TemporaryRecording {
public:
  [[nodiscard]] static Expected<TemporaryRecording> create(recording::WriterOptions options) {
    std::error_code problem;
    std::string folder = std::filesystem::temp_directory_path(problem) / "dyncal-XXXXXX";
    if (problem || ::mkdtemp(folder.data()) == nullptr) {
      return fail(ErrorCode::bad_file,
                  fmt::format("{}: cannot be made ({}); name another folder for temporary files in "
                              "TMPDIR",
                              folder, problem ? problem.message() : std::strerror(errno)));
    }
    auto writer = recording::RecordingWriter::create(
        std::filesystem::path(folder) / recording_file_name, std::move(options));
    if (!writer) {
      std::filesystem::remove_all(folder, problem);
      return fail(writer.error());
    }
    return TemporaryRecording(folder, std::move(*writer));
  }
  TemporaryRecording(TemporaryRecording&& other) noexcept = default;
  TemporaryRecording& operator=(TemporaryRecording&&) = delete;
  ~TemporaryRecording() {
    if (!folder_.empty()) {
      std::error_code ignored;
      std::filesystem::remove_all(folder_, ignored);
    }
  }

  // Messages in the order in which they are added. REQUIRES: a channel of the options.
  [[nodiscard]] Expected<void> add(const recording::Channel& channel,
                                   const recording::Message& message) {
    chunk_.add(channel, message);
    return chunk_.records().size() < chunk_bytes ? Expected<void>{} : flush();
  }
  [[nodiscard]] Expected<void> add(const recording::Attachment& attachment) {
    return flush().and_then([&] { return writer_.add_attachment(attachment); });
  }
  [[nodiscard]] Expected<void> add(recording::Metadata metadata) {
    return flush().and_then([&] { return writer_.add_metadata(std::move(metadata)); });
  }
  // The object is spent afterwards. `name`: for messages of the reader.
  [[nodiscard]] Expected<recording::RecordingReader> read(const std::filesystem::path& name) {
    DYNCAL_TRY(flush().and_then([&] { return writer_.close(); }));
    drivers::FileDescriptor file(
        ::open((folder_ / recording_file_name).c_str(), O_RDONLY | O_CLOEXEC));
    if (!file.is_open()) {
      return fail(ErrorCode::bad_file,
                  fmt::format("{}: cannot be read again ({})",
                              (folder_ / recording_file_name).string(), std::strerror(errno)));
    }
    return recording::RecordingReader::read(std::move(file), name);
  }

private:
  TemporaryRecording(std::filesystem::path folder, recording::RecordingWriter writer)
      : folder_(std::move(folder)), writer_(std::move(writer)) {}
  [[nodiscard]] Expected<void> flush() {
    auto written = chunk_.empty() ? Expected<void>{} : writer_.add_chunk(chunk_);
    chunk_ = {};
    return written;
  }

  std::filesystem::path folder_; // empty: moved from
  recording::RecordingWriter writer_;
  recording::Chunk chunk_;
};

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
