#include "services/records/exchange/temporary_recording.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <string>

#include <fmt/core.h>

namespace dyncal::inline records {
namespace {

constexpr std::size_t chunk_bytes = std::size_t{1} << 20U;
constexpr const char* file_name = "recording.mcap";

} // namespace

Expected<TemporaryRecording> TemporaryRecording::create(recording::WriterOptions options) {
  std::error_code problem;
  std::string folder = std::filesystem::temp_directory_path(problem) / "dyncal-XXXXXX";
  if (problem || ::mkdtemp(folder.data()) == nullptr) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot be made ({}); name another folder for temporary files in "
                            "TMPDIR",
                            folder, problem ? problem.message() : std::strerror(errno)));
  }
  auto writer = recording::RecordingWriter::create(std::filesystem::path(folder) / file_name,
                                                   std::move(options));
  if (!writer) {
    std::filesystem::remove_all(folder, problem);
    return fail(writer.error());
  }
  return TemporaryRecording(folder, std::move(*writer));
}

TemporaryRecording::~TemporaryRecording() {
  if (!folder_.empty()) {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
}

Expected<void> TemporaryRecording::flush() {
  auto written = chunk_.empty() ? Expected<void>{} : writer_.add_chunk(chunk_);
  chunk_ = {};
  return written;
}

Expected<void> TemporaryRecording::add(const recording::Channel& channel,
                                       const recording::Message& message) {
  chunk_.add(channel, message);
  return chunk_.records().size() < chunk_bytes ? Expected<void>{} : flush();
}

Expected<void> TemporaryRecording::add(const recording::Attachment& attachment) {
  return flush().and_then([&] { return writer_.add_attachment(attachment); });
}

Expected<void> TemporaryRecording::add(recording::Metadata metadata) {
  return flush().and_then([&] { return writer_.add_metadata(std::move(metadata)); });
}

Expected<recording::RecordingReader> TemporaryRecording::read(const std::filesystem::path& name) {
  DYNCAL_TRY(flush().and_then([&] { return writer_.close(); }));
  drivers::FileDescriptor file(::open((folder_ / file_name).c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot be read again ({})", (folder_ / file_name).string(),
                            std::strerror(errno)));
  }
  return recording::RecordingReader::read(std::move(file), name);
}

} // namespace dyncal::inline records
