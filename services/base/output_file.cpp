#include "services/base/output_file.hpp"

#include <cerrno>
#include <fcntl.h>
#include <unistd.h>

#include "services/base/output_stream.hpp"

namespace dyncal::inline base {
namespace {

bool is_something_else(const std::filesystem::path& path) {
  std::error_code unknown;
  const auto status = std::filesystem::status(path, unknown);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
}

Expected<void> write_through(const std::filesystem::path& path, std::string_view text) {
  const drivers::FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  while (file.is_open() && !text.empty()) {
    const ssize_t count = ::write(file.number(), text.data(), text.size());
    if (count < 0 && errno != EINTR) {
      return cannot_be_written(path, errno);
    }
    text.remove_prefix(count < 0 ? 0 : static_cast<std::size_t>(count));
  }
  return file.is_open() ? Expected<void>{} : cannot_be_written(path, errno);
}

} // namespace

Expected<void> write_output_file(const std::filesystem::path& path, std::string_view text) {
  if (is_something_else(path)) {
    return write_through(path, text);
  }
  DYNCAL_TRY(auto file, OutputStream::replace(path));
  return file.write(text).and_then([&] { return file.finish(); });
}

Expected<void> write_new_file(const std::filesystem::path& path, std::string_view text) {
  DYNCAL_TRY(auto file, OutputStream::create(path));
  return file.write(text).and_then([&] { return file.finish(); });
}

Expected<void> check_new_file(const std::filesystem::path& path) {
  return check_new_output(path).and_then([&] { return check_output_file(path); });
}

Expected<void> check_output_file(const std::filesystem::path& path) {
  if (path.filename().empty() || std::filesystem::is_directory(path)) {
    return cannot_be_written(path, EISDIR);
  }
  return is_something_else(path) ? Expected<void>{}
                                 : OutputStream::replace(path).map([](auto&&) {});
}

Expected<void> check_output_folder(const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) {
    return cannot_be_written(folder, problem.value());
  }
  return check_output_file(folder / "figure");
}

} // namespace dyncal::inline base
