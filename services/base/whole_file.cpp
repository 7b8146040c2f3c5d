#include "services/base/whole_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>

#include <fmt/core.h>

namespace dyncal::inline base {

Expected<std::string> read_whole_file(const std::filesystem::path& path, std::uintmax_t max_bytes) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: is a folder; name a file in it", path.string()));
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot be read ({})", path.string(), std::strerror(errno)));
  }
  std::string text;
  std::string part(1U << 16U, '\0');
  while (stream.read(part.data(), static_cast<std::streamsize>(part.size())) ||
         stream.gcount() > 0) {
    text.append(part, 0, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > max_bytes) {
      return fail(ErrorCode::bad_file, fmt::format("{}: is larger than {} bytes, which no such "
                                                   "file needs; is it the right one?",
                                                   path.string(), max_bytes));
    }
  }
  if (stream.bad()) {
    return fail(ErrorCode::bad_file, fmt::format("{}: cannot be read whole", path.string()));
  }
  return text;
}

} // namespace dyncal::inline base
