// A picture file as it goes into a document: its bytes and their type. PNG and JPEG are told by
// their first bytes; an SVG is taken only if it fetches nothing and runs nothing: no script, no
// DOCTYPE, no style import, no reference but to itself or to embedded data.
//
// Fails (bad_file) with the file and the reason: not there, larger than 4 MiB, of another type, or
// an SVG as above. Any thread.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "services/base/error.hpp"

namespace dyncal::inline views {

struct EmbeddedPicture {
  std::string file_name;
  std::string mime_type;
  std::string bytes;

  // "data:image/png;base64,..."
  [[nodiscard]] std::string data_uri() const;
};

[[nodiscard]] Expected<EmbeddedPicture> read_picture(const std::filesystem::path& path);

// Without line breaks.
[[nodiscard]] std::string base64(std::string_view bytes);

} // namespace dyncal::inline views
