#include "services/bench/draft/new_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fmt/core.h>

#include "services/base/output_file.hpp"

namespace dyncal::inline bench::bench_draft {

namespace {

tl::unexpected<Error> taken(const std::filesystem::path& path) {
  return fail(ErrorCode::bad_file,
              fmt::format("{}: there is such a file already, which is left as it is; give another "
                          "name with --output",
                          path.string()));
}

// Never in place of another; the second way is for file systems without links. 0, or why not.
int take_name(const std::filesystem::path& beside, const std::filesystem::path& path) {
  if (::link(beside.c_str(), path.c_str()) == 0) {
    return 0;
  }
  if (errno == EEXIST) {
    return EEXIST;
  }
  return ::renameat2(AT_FDCWD, beside.c_str(), AT_FDCWD, path.c_str(), RENAME_NOREPLACE) == 0
             ? 0
             : errno;
}

} // namespace

Expected<void> check_new_file(const std::filesystem::path& path) {
  std::error_code unknown;
  const auto status = std::filesystem::symlink_status(path, unknown);
  return std::filesystem::exists(status) ? taken(path) : check_output_file(path);
}

Expected<void> write_new_file(const std::filesystem::path& path, std::string_view text) {
  const std::filesystem::path beside =
      path.parent_path() / fmt::format(".{}.{}", path.filename().string(), getpid());
  if (auto written = write_output_file(beside, text); !written) {
    return written;
  }
  const int reason = take_name(beside, path);
  std::error_code ignored;
  std::filesystem::remove(beside, ignored);
  if (reason == 0) {
    return {};
  }
  return reason == EEXIST
             ? taken(path)
             : fail(ErrorCode::bad_file, fmt::format("{}: cannot write this file: {}",
                                                     path.string(), std::strerror(reason)));
}

} // namespace dyncal::inline bench::bench_draft
