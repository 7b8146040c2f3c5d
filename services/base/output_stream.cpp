#include "services/base/output_stream.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

#include <fmt/core.h>

namespace dyncal::inline base {
namespace {

constexpr mode_t for_everybody = 0666; // less what the umask takes
constexpr std::size_t buffer_bytes = std::size_t{1} << 20U;

tl::unexpected<Error> is_there(const std::filesystem::path& path) {
  return fail(ErrorCode::bad_file,
              fmt::format("{}: is there already, and nothing is overwritten: choose another name "
                          "or remove it",
                          path.string()));
}

// The name reaches the disk with its folder. Whether it did shows after a power cut alone.
void synchronise_folder_of(const std::filesystem::path& path) {
  const auto folder = path.parent_path();
  const drivers::FileDescriptor opened(
      ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.is_open()) {
    ::fsync(opened.number());
  }
}

Expected<void> take_name_of_older(const std::filesystem::path& unfinished,
                                  const std::filesystem::path& path) {
  if (std::rename(unfinished.c_str(), path.c_str()) != 0) {
    return cannot_be_written(path, errno);
  }
  synchronise_folder_of(path);
  return {};
}

} // namespace

tl::unexpected<Error> cannot_be_written(const std::filesystem::path& path, int cause) {
  return fail(ErrorCode::bad_file,
              fmt::format("{}: cannot be written ({}); choose another folder or make room",
                          path.string(), std::strerror(cause)));
}

Expected<void> write_at(const drivers::FileDescriptor& file, std::uint64_t offset,
                        std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t count =
        ::pwrite(file.number(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count <= 0) {
      return cannot_be_written(path, count < 0 ? errno : ENOSPC);
    }
    bytes.remove_prefix(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
  return {};
}

Expected<void> check_new_output(const std::filesystem::path& path) {
  std::error_code unknown;
  return path.filename().empty() ||
                 std::filesystem::exists(std::filesystem::symlink_status(path, unknown))
             ? Expected<void>(is_there(path))
             : Expected<void>{};
}

Expected<void> take_output_name(const std::filesystem::path& unfinished,
                                const std::filesystem::path& path) {
  int renamed = ::renameat2(AT_FDCWD, unfinished.c_str(), AT_FDCWD, path.c_str(), RENAME_NOREPLACE);
  if (renamed != 0 && (errno != EEXIST || std::filesystem::is_directory(unfinished)) &&
      (!std::filesystem::exists(path) || std::filesystem::is_directory(path))) {
    renamed = std::rename(unfinished.c_str(), path.c_str());
  }
  if (renamed != 0) {
    const int cause = errno;
    return cause == EEXIST || cause == ENOTEMPTY ? is_there(path) : cannot_be_written(path, cause);
  }
  synchronise_folder_of(path);
  return {};
}

Expected<OutputStream> OutputStream::create(const std::filesystem::path& path) {
  DYNCAL_TRY(check_new_output(path));
  DYNCAL_TRY(auto stream, replace(path));
  stream.replaces_ = false;
  return stream;
}

Expected<OutputStream> OutputStream::replace(const std::filesystem::path& path) {
  std::filesystem::path unfinished = path.string() + ".part";
  drivers::FileDescriptor file(
      ::open(unfinished.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, for_everybody));
  if (!file.is_open()) {
    return cannot_be_written(path, errno);
  }
  OutputStream stream(path, std::move(unfinished), std::move(file));
  stream.replaces_ = true;
  return stream;
}

OutputStream::~OutputStream() {
  if (file_.is_open()) {
    ::unlink(unfinished_.c_str());
  }
}

tl::unexpected<Error> OutputStream::not_written(int cause) const {
  return cannot_be_written(path_, cause);
}

Expected<void> OutputStream::flush() {
  auto done = write_at(file_, written_ - buffer_.size(), buffer_, path_);
  buffer_.clear();
  return done;
}

Expected<void> OutputStream::write(std::string_view bytes) {
  buffer_ += bytes;
  written_ += bytes.size();
  return buffer_.size() < buffer_bytes ? Expected<void>{} : flush();
}

Expected<void> OutputStream::overwrite(std::uint64_t offset, std::string_view bytes) {
  return flush().and_then([&] { return write_at(file_, offset, bytes, path_); });
}

Expected<void> OutputStream::finish() {
  DYNCAL_TRY(flush());
  if (::fsync(file_.number()) != 0) {
    return not_written(errno);
  }
  auto named =
      replaces_ ? take_name_of_older(unfinished_, path_) : take_output_name(unfinished_, path_);
  if (named) {
    const drivers::FileDescriptor finished(std::move(file_));
  }
  return named;
}

Expected<OutputFolder> OutputFolder::create(const std::filesystem::path& path) {
  std::error_code problem;
  const bool has_name = !path.filename().empty();
  if (std::filesystem::exists(path, problem) &&
      !(std::filesystem::is_directory(path, problem) && std::filesystem::is_empty(path, problem))) {
    return is_there(path);
  }
  OutputFolder folder(path, (has_name ? path : path.parent_path()).string() + ".part");
  std::filesystem::remove_all(folder.unfinished_, problem);
  std::filesystem::create_directories(folder.unfinished_, problem);
  if (problem) {
    return cannot_be_written(path, problem.value());
  }
  return folder;
}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : path_(std::move(other.path_)), unfinished_(std::exchange(other.unfinished_, {})) {}

OutputFolder::~OutputFolder() {
  if (!unfinished_.empty()) {
    std::error_code ignored;
    std::filesystem::remove_all(unfinished_, ignored);
  }
}

Expected<void> OutputFolder::finish() {
  auto named = take_output_name(unfinished_, path_);
  if (named) {
    unfinished_.clear();
  }
  return named;
}

} // namespace dyncal::inline base
