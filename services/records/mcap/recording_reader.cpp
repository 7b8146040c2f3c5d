#include "services/records/mcap/recording_reader.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/core.h>

#include "services/records/mcap/chunk_codec.hpp"
#include "services/records/mcap/scan.hpp"

namespace dyncal::inline records::recording {

using base::ErrorCode;
using base::Expected;

std::string to_string(const Damage& damage, const std::filesystem::path& path) {
  return fmt::format("{}: at byte {} ({} bytes): {}", path.string(), damage.offset, damage.bytes,
                     damage.what);
}

Expected<RecordingReader> RecordingReader::open(const std::filesystem::path& path) {
  drivers::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot be read ({})", path.string(), std::strerror(errno)));
  }
  return read(std::move(file), path);
}

Expected<RecordingReader> RecordingReader::read(drivers::FileDescriptor file,
                                                std::filesystem::path name) {
  struct stat status {};
  if (::fstat(file.number(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return fail(ErrorCode::bad_file, fmt::format("{}: is not a file", name.string()));
  }
  RecordingReader reader(std::move(name), std::move(file),
                         static_cast<std::uint64_t>(status.st_size));
  DYNCAL_TRY(const auto begin,
             reader.bytes(0, std::min<std::uint64_t>(reader.size_, magic.size())));
  if (begin != magic) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: at byte 0: this is not an MCAP recording", reader.path_.string()));
  }
  return reader;
}

Expected<std::string> RecordingReader::bytes(std::uint64_t offset, std::uint64_t count) const {
  std::string bytes(count, '\0');
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got = ::pread(file_.number(), bytes.data() + done, count - done,
                                static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      return fail(ErrorCode::bad_file,
                  fmt::format("{}: at byte {}: cannot be read ({})", path_.string(), offset + done,
                              got < 0 ? std::strerror(errno) : "the file became shorter"));
    }
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

namespace {

Expected<std::string> records_of(const ChunkHead& chunk) {
  auto records = uncompress(chunk.records, chunk.compression, chunk.uncompressed_size);
  if (records && chunk.crc != 0 && crc32_of(*records) != chunk.crc) {
    return fail(ErrorCode::bad_file, "its CRC is wrong");
  }
  return records;
}

} // namespace

Expected<std::string> RecordingReader::chunk_records(std::uint64_t offset) const {
  const std::string where = fmt::format("{}: at byte {}: ", path_.string(), offset);
  if (offset + head_bytes > size_) {
    return fail(ErrorCode::bad_file, where + "there is no chunk");
  }
  const auto head = bytes(offset, head_bytes);
  if (!head) {
    return head;
  }
  const std::uint64_t length = number_at(*head, 1, 8);
  const auto opcode = static_cast<Opcode>((*head)[0]);
  if ((opcode != Opcode::chunk && opcode != Opcode::message) ||
      length > size_ - offset - head_bytes || length > max_record_bytes) {
    return fail(ErrorCode::bad_file, where + "there is no chunk");
  }
  const auto content = bytes(offset + head_bytes, length);
  if (!content || opcode == Opcode::message) {
    return content ? *head + *content : content;
  }
  const auto chunk = parse_chunk(*content);
  if (!chunk) {
    return fail(ErrorCode::bad_file, where + "the chunk's lengths do not fit");
  }
  auto records = records_of(*chunk);
  if (!records) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}the chunk is damaged: {}", where, records.error().message));
  }
  return records;
}

Expected<ScanReport> RecordingReader::scan(const ScanEvents& events) {
  return Scan(*this, events).run();
}

} // namespace dyncal::inline records::recording
