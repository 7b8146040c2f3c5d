// A file of one of the folders that are served, and the answer with it: whole, a range of it, or
// that it is the one the visitor has (RFC 9110, sections 8.8, 13 and 14).
//
// The kernel holds every step of the way within the folder (openat2, Linux 5.6): no "..", and of
// links none (run folders, which many programs write) or only those that stay within (libraries of
// the system). Only regular files are opened. The ETag is of size and time of change. A range is
// one of bytes; anything else is answered with the whole file. Plain functions; any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <httplib.h>

#include "drivers/link/file_descriptor.hpp"

namespace dyncal::inline programs::web {

enum class Links { none, within };

struct ServedFile {
  std::shared_ptr<drivers::FileDescriptor> descriptor;
  std::size_t bytes = 0;
  std::string etag; // with its quotes
};
// `name`: relative to `folder`. Nothing: there is no such file, or it is not served.
[[nodiscard]] std::optional<ServedFile> open_beneath(const std::filesystem::path& folder,
                                                     const std::string& name, Links links);

// For those who look into it; nothing: it is larger, or cannot be read.
[[nodiscard]] std::optional<std::string> whole_text(const ServedFile& file, std::size_t max_bytes);

struct ByteRange {
  std::size_t first = 0;
  std::size_t count = 0;
};
// Of the field Range, "bytes=0-99", "bytes=100-" or "bytes=-100". Nothing: it is none, and is
// ignored; a `count` of 0: nothing of the file is in it.
[[nodiscard]] std::optional<ByteRange> parse_range(std::string_view text, std::size_t bytes);

// If-None-Match names it.
[[nodiscard]] bool names_etag(std::string_view field, std::string_view etag);

void answer_with(const ServedFile& file, const std::string& media_type,
                 const httplib::Request& request, httplib::Response& response);

} // namespace dyncal::inline programs::web
