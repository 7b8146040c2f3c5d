#include "services/programs/web/served_file.hpp"

#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

#include <fmt/core.h>

#include "services/base/parsed_number.hpp"
#include "services/programs/web/request_head.hpp"
#include "services/programs/web/request_router.hpp"

namespace dyncal::inline programs::web {
namespace {

using drivers::FileDescriptor;

constexpr std::size_t part_bytes = std::size_t{64} * 1024;

// A range of what the visitor has in part, unless he has another state of it (If-Range).
std::optional<ByteRange> range_of(const ServedFile& file, const httplib::Request& request) {
  const std::string wanted = request.get_header_value("If-Range");
  if (request.method != "GET" || (!wanted.empty() && wanted != file.etag)) {
    return std::nullopt;
  }
  return parse_range(request.get_header_value(range_field), file.bytes);
}

} // namespace

std::optional<ServedFile> open_beneath(const std::filesystem::path& folder, const std::string& name,
                                       Links links) {
  const FileDescriptor root(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  open_how how{};
  how.flags =
      O_RDONLY | O_CLOEXEC | O_NONBLOCK; // anyone who opens a pipe would wait for its writer
  how.resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS |
                (links == Links::none ? std::uint64_t{RESOLVE_NO_SYMLINKS} : 0U);
  auto opened = std::make_shared<FileDescriptor>(
      static_cast<int>(::syscall(SYS_openat2, root.number(), name.c_str(), &how, sizeof(how))));
  struct stat status {};
  if (!opened->is_open() || ::fstat(opened->number(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return std::nullopt;
  }
  std::string etag = fmt::format("\"{:x}-{:x}-{:x}\"", status.st_size, status.st_mtim.tv_sec,
                                 status.st_mtim.tv_nsec);
  return ServedFile{std::move(opened), static_cast<std::size_t>(status.st_size), std::move(etag)};
}

std::optional<std::string> whole_text(const ServedFile& file, std::size_t max_bytes) {
  if (file.bytes > max_bytes) {
    return std::nullopt;
  }
  std::string text(file.bytes, '\0');
  std::size_t read = 0;
  while (read < text.size()) {
    const ssize_t count = ::pread(file.descriptor->number(), text.data() + read, text.size() - read,
                                  static_cast<off_t>(read));
    if (count <= 0) {
      return std::nullopt;
    }
    read += static_cast<std::size_t>(count);
  }
  return text;
}

std::optional<ByteRange> parse_range(std::string_view text, std::size_t bytes) {
  constexpr std::string_view unit = "bytes=";
  const auto dash = text.find('-');
  if (!text.starts_with(unit) || dash == std::string_view::npos) {
    return std::nullopt;
  }
  const std::string_view begin = text.substr(unit.size(), dash - unit.size());
  const std::string_view end = text.substr(dash + 1);
  const auto first = parsed_number<std::size_t>(begin);
  const auto last = parsed_number<std::size_t>(end);
  if ((!first && !begin.empty()) || (!last && !end.empty()) || (!first && !last) ||
      (first && last && *last < *first)) {
    return std::nullopt;
  }
  if (!first) { // the last bytes
    const std::size_t count = std::min(*last, bytes);
    return ByteRange{bytes - count, count};
  }
  if (*first >= bytes) {
    return ByteRange{};
  }
  return ByteRange{*first, std::min(last.value_or(bytes - 1), bytes - 1) - *first + 1};
}

bool names_etag(std::string_view field, std::string_view etag) {
  return field == "*" || field.find(etag) != std::string_view::npos; // quotes are in no other tag
}

void answer_with(const ServedFile& file, const std::string& media_type,
                 const httplib::Request& request, httplib::Response& response) {
  response.set_header("ETag", file.etag);
  response.set_header("Accept-Ranges", "bytes");
  if (names_etag(request.get_header_value("If-None-Match"), file.etag)) {
    response.status = 304;
    response.set_header("Content-Length", std::to_string(file.bytes)); // of what is not sent
    return;
  }
  ByteRange range{0, file.bytes};
  if (const auto wanted = range_of(file, request)) {
    if (wanted->count == 0) {
      response.set_header("Content-Range", fmt::format("bytes */{}", file.bytes));
      answer_error(416, "malformed", "the file has no such bytes", response);
      return;
    }
    range = *wanted;
    response.status = 206;
    response.set_header("Content-Range", fmt::format("bytes {}-{}/{}", range.first,
                                                     range.first + range.count - 1, file.bytes));
  }
  if (range.count == 0) { // the library takes no provider of nothing
    response.set_content("", media_type);
    return;
  }
  response.set_content_provider(
      range.count, media_type,
      [descriptor = file.descriptor, first = range.first](std::size_t offset, std::size_t length,
                                                          httplib::DataSink& sink) {
        std::vector<char> bytes(std::min(length, part_bytes));
        const ssize_t count = ::pread(descriptor->number(), bytes.data(), bytes.size(),
                                      static_cast<off_t>(first + offset));
        return count > 0 && sink.write(bytes.data(), static_cast<std::size_t>(count));
      });
}

} // namespace dyncal::inline programs::web
