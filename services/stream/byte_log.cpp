#include "services/stream/byte_log.hpp"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

namespace dyncal::inline stream {

namespace {

Error file_error(const std::filesystem::path& folder, const std::string& what, int code) {
  return {ErrorCode::bad_file,
          folder.string() + ": " + what + ": " + std::generic_category().message(code)};
}

int open_without_name(const std::filesystem::path& folder) {
  const int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC | O_EXCL, 0600);
  if (file >= 0) {
    return file;
  }
  std::string name = (folder / "dyncal-XXXXXX").string(); // not every file system has O_TMPFILE
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) {
    unlink(name.c_str());
  }
  return named;
}

} // namespace

Expected<ByteLog> ByteLog::create(const std::filesystem::path& folder, Limits limits) {
  const int file = open_without_name(folder);
  if (file < 0) {
    return fail(file_error(folder, "cannot make a file here", errno));
  }
  return ByteLog(file, folder, limits);
}

ByteLog::ByteLog(ByteLog&& other) noexcept
    : file_(std::exchange(other.file_, -1)), folder_(std::move(other.folder_)),
      limits_(other.limits_), first_chunk_(other.first_chunk_), chunks_(std::move(other.chunks_)),
      free_(std::move(other.free_)), chunks_in_file_(other.chunks_in_file_), end_(other.end_) {}

ByteLog::~ByteLog() {
  if (file_ >= 0) {
    close(file_);
  }
}

Expected<void> ByteLog::make_room(std::uint64_t end) {
  while ((first_chunk_ + chunks_.size()) * chunk_bytes < end) {
    if (!free_.empty()) {
      chunks_.push_back(free_.back());
      free_.pop_back();
      continue;
    }
    if ((chunks_in_file_ + 1) * chunk_bytes > limits_.bytes) {
      return fail(ErrorCode::bad_file, folder_.string() + ": the file holds all that it may, " +
                                           std::to_string(limits_.bytes >> 20U) + " MiB");
    }
    struct statvfs system {};
    if (fstatvfs(file_, &system) == 0 &&
        std::uint64_t{system.f_bavail} * system.f_frsize < limits_.min_free_bytes + chunk_bytes) {
      return fail(ErrorCode::bad_file, folder_.string() + ": its file system is nearly full");
    }
    // All of it now: a full disk is met here, and not in the middle of a message.
    const auto begin = static_cast<off_t>(chunks_in_file_ * chunk_bytes);
    if (const int refused = posix_fallocate(file_, begin, static_cast<off_t>(chunk_bytes));
        refused != 0) {
      return fail(file_error(folder_, "cannot make a file longer", refused));
    }
    chunks_.push_back(chunks_in_file_++);
  }
  return {};
}

template <class Transfer>
bool ByteLog::for_each_piece(std::uint64_t offset, std::size_t size, Transfer&& transfer) const {
  for (std::size_t done = 0; done < size;) {
    const std::uint64_t at = offset + done;
    const auto piece = static_cast<std::size_t>(
        std::min<std::uint64_t>(size - done, chunk_bytes - at % chunk_bytes));
    const std::uint64_t chunk = chunks_.at(at / chunk_bytes - first_chunk_);
    const ssize_t moved =
        transfer(static_cast<off_t>(chunk * chunk_bytes + at % chunk_bytes), done, piece);
    if (moved < 0 && errno == EINTR) {
      continue;
    }
    if (moved <= 0) {
      return false;
    }
    done += static_cast<std::size_t>(moved);
  }
  return true;
}

Expected<std::uint64_t> ByteLog::append(std::string_view bytes) {
  DYNCAL_TRY(make_room(end_ + bytes.size()));
  const bool written =
      for_each_piece(end_, bytes.size(), [&](off_t position, std::size_t first, std::size_t count) {
        return pwrite(file_, bytes.data() + first, count, position);
      });
  if (!written) {
    return fail(file_error(folder_, "cannot write", errno));
  }
  return std::exchange(end_, end_ + bytes.size());
}

Expected<std::string> ByteLog::read(std::uint64_t offset, std::size_t size) const {
  std::string bytes(size, '\0');
  errno = 0;
  const bool read =
      for_each_piece(offset, size, [&](off_t position, std::size_t first, std::size_t count) {
        return pread(file_, bytes.data() + first, count, position);
      });
  if (!read) {
    return fail(file_error(folder_, "cannot read", errno));
  }
  return bytes;
}

void ByteLog::drop_before(std::uint64_t offset) {
  while (!chunks_.empty() && (first_chunk_ + 1) * chunk_bytes <= std::min(offset, end_)) {
    free_.push_back(chunks_.front());
    chunks_.pop_front();
    ++first_chunk_;
  }
}

std::filesystem::path folder_for_kept_messages() {
  for (const char* variable : {"CACHE_DIRECTORY", "STATE_DIRECTORY"}) {
    if (const char* folders = std::getenv(variable); folders != nullptr && *folders != '\0') {
      const std::string list = folders;
      return list.substr(0, list.find(':'));
    }
  }
  std::error_code none;
  const auto folder = std::filesystem::temp_directory_path(none);
  return none ? "/tmp" : folder;
}

} // namespace dyncal::inline stream
