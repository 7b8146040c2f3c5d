#include "services/records/mcap/recording_file.hpp"

#include <cerrno>
#include <fcntl.h>
#include <string>
#include <sys/statvfs.h>
#include <unistd.h>

#include <fmt/core.h>

#include "services/base/output_stream.hpp"
#include "services/records/mcap/mcap_record.hpp"

namespace dyncal::inline records::recording {
namespace {

using base::Expected;

constexpr mode_t for_everybody = 0666; // less what the umask takes
constexpr std::uint64_t page = 4096;
constexpr std::uint64_t spare_bytes = std::uint64_t{16} << 20U; // of a new filler

std::string shortest_end() {
  std::string end;
  append_data_end(end, 0);
  append_footer(end, {});
  end += magic;
  return end;
}

std::string filler_head(std::uint64_t begin, std::uint64_t limit) {
  std::string head;
  append_head(head, Opcode::filler, limit - begin - head_bytes);
  return head;
}

// A record's head at such a place lies across two pages, and could be divided.
bool is_divided(std::uint64_t offset) {
  return offset % page > page - head_bytes;
}

} // namespace

Expected<RecordingFile> RecordingFile::create(const std::filesystem::path& path,
                                              std::string_view beginning) {
  const std::string unfinished = fmt::format("{}.{}.part", path.string(), ::getpid());
  ::unlink(unfinished.c_str());
  RecordingFile file(
      path, drivers::FileDescriptor(
                ::open(unfinished.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, for_everybody)));
  if (!file.file_.is_open()) {
    return base::cannot_be_written(path, errno);
  }
  auto begun =
      file.begin(beginning).and_then([&] { return base::take_output_name(unfinished, path); });
  if (!begun) {
    ::unlink(unfinished.c_str());
    return fail(begun.error());
  }
  return file;
}

Expected<void> RecordingFile::begin(std::string_view beginning) {
  std::string records(beginning);
  if (is_divided(records.size())) {
    append_head(records, Opcode::filler, 0);
  }
  end_ = records.size();
  crc_ = crc32_of(records);
  return write(records, 0).and_then([&] { return extend(0); }).and_then([&]() -> Expected<void> {
    return ::fsync(file_.number()) == 0 ? Expected<void>{} : base::cannot_be_written(path_, errno);
  });
}

Expected<void> RecordingFile::write(std::string_view bytes, std::uint64_t offset) const {
  return base::write_at(file_, offset, bytes, path_);
}

// The new end lies within one page, like the old one.
Expected<void> RecordingFile::extend(std::uint64_t needed) {
  const std::string end = shortest_end();
  const std::uint64_t least = end_ + head_bytes + needed + spare_bytes + end.size();
  const std::uint64_t limit = (least + page - 1) / page * page - end.size();
  return write(end, limit).and_then([&] { return write(filler_head(end_, limit), end_); }).map([&] {
    limit_ = limit;
  });
}

Expected<void> RecordingFile::append(std::span<const std::string_view> parts, std::uint32_t crc) {
  std::uint64_t bytes = 0;
  for (const std::string_view part : parts) {
    bytes += part.size();
  }
  std::string filler;
  if (is_divided(end_ + bytes)) {
    append_head(filler, Opcode::filler, 0);
  }
  const std::uint64_t new_end = end_ + bytes + filler.size();
  if (new_end + head_bytes > limit_) {
    DYNCAL_TRY(extend(new_end - end_));
  }
  std::uint64_t offset = end_ + head_bytes;
  for (std::string_view part : parts) {
    if (offset == end_ + head_bytes) {
      part.remove_prefix(head_bytes);
    }
    DYNCAL_TRY(write(part, offset));
    offset += part.size();
  }
  auto committed = write(filler + filler_head(new_end, limit_), offset).and_then([&] {
    return write(parts.front().substr(0, head_bytes), end_);
  });
  if (committed) {
    crc_ = crc32_of(filler, joined_crc32(crc_, crc, bytes));
    end_ = new_end;
  }
  return committed;
}

Expected<void> RecordingFile::finish(std::string_view ending) {
  const std::uint64_t size = end_ + ending.size();
  if (size > limit_) {
    DYNCAL_TRY(extend(ending.size()));
  }
  const auto finished = write(ending.substr(head_bytes), end_ + head_bytes).and_then([&] {
    return write(ending.substr(0, head_bytes), end_);
  });
  if (!finished) {
    return finished;
  }
  end_ = size;
  const bool done =
      ::ftruncate(file_.number(), static_cast<off_t>(size)) == 0 && ::fsync(file_.number()) == 0;
  return done ? Expected<void>{} : base::cannot_be_written(path_, errno);
}

Expected<void> RecordingFile::synchronise() {
  return ::fdatasync(file_.number()) == 0 ? Expected<void>{}
                                          : base::cannot_be_written(path_, errno);
}

std::uint64_t RecordingFile::free_bytes() const {
  struct statvfs disk {};
  return ::fstatvfs(file_.number(), &disk) == 0
             ? static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize
             : 0;
}

} // namespace dyncal::inline records::recording
