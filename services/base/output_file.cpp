#include "services/base/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <string>
#include <unistd.h>

#include <fmt/core.h>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::inline base {
namespace {

using drivers::FileDescriptor;

constexpr mode_t for_everybody = 0666; // less what the umask takes

tl::unexpected<Error> not_written(const std::filesystem::path& path, int cause) {
  return fail(ErrorCode::bad_file,
              fmt::format("{}: cannot be written ({}); choose another folder or make room",
                          path.string(), std::strerror(cause)));
}

// Nothing when all of it is on its way to the disk, else errno.
std::optional<int> write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor, text.data(), text.size());
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count < 0) {
      return errno;
    }
    text.remove_prefix(static_cast<std::size_t>(count));
  }
  return std::nullopt;
}

bool is_something_else(const std::filesystem::path& path) {
  std::error_code unknown;
  const auto status = std::filesystem::status(path, unknown);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
}

Expected<void> write_through(const std::filesystem::path& path, std::string_view text) {
  const FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (!file.is_open()) {
    return not_written(path, errno);
  }
  if (const auto cause = write_all(file.number(), text)) {
    return not_written(path, *cause);
  }
  return {};
}

std::filesystem::path unfinished_name(const std::filesystem::path& path) {
  return path.string() + ".part";
}

// Removed again unless it has taken its name.
class UnfinishedFile {
public:
  explicit UnfinishedFile(const std::filesystem::path& path)
      : name_(unfinished_name(path)),
        file_(::open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, for_everybody)) {}
  ~UnfinishedFile() {
    if (file_.is_open() && !finished_) {
      ::unlink(name_.c_str());
    }
  }
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  [[nodiscard]] int descriptor() const { return file_.number(); }
  [[nodiscard]] bool take_name(const std::filesystem::path& path) {
    finished_ = ::rename(name_.c_str(), path.c_str()) == 0;
    return finished_;
  }

private:
  std::filesystem::path name_;
  FileDescriptor file_;
  bool finished_ = false;
};

// The name is on the disk as well. A file system that cannot do that leaves the file as it is.
void synchronise_folder(const std::filesystem::path& path) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  const FileDescriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.is_open()) {
    ::fsync(opened.number());
  }
}

} // namespace

Expected<void> write_output_file(const std::filesystem::path& path, std::string_view text) {
  if (is_something_else(path)) {
    return write_through(path, text);
  }
  UnfinishedFile file(path);
  if (file.descriptor() < 0) {
    return not_written(path, errno);
  }
  if (const auto cause = write_all(file.descriptor(), text)) {
    return not_written(path, *cause);
  }
  if (::fsync(file.descriptor()) != 0 || !file.take_name(path)) {
    return not_written(path, errno);
  }
  synchronise_folder(path);
  return {};
}

Expected<void> check_output_file(const std::filesystem::path& path) {
  if (path.filename().empty() || std::filesystem::is_directory(path)) {
    return not_written(path, EISDIR);
  }
  if (is_something_else(path)) {
    return {};
  }
  const UnfinishedFile file(path);
  return file.descriptor() >= 0 ? Expected<void>{} : not_written(path, errno);
}

Expected<void> check_output_folder(const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) {
    return not_written(folder, problem.value());
  }
  return check_output_file(folder / "figure");
}

} // namespace dyncal::inline base
