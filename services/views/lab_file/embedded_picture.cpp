#include "services/views/lab_file/embedded_picture.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include <fmt/core.h>
#include <openssl/evp.h>

#include "services/base/whole_file.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::uintmax_t max_picture_bytes = 4U << 20U;

// What would let a picture fetch, run or hide something.
constexpr std::array forbidden_in_svg{
    "<script",   "<!doctype", "<!entity", "@import",  "<foreignobject", "javascript:",
    "<?xml-sty", "xml:base",  "<set",     "<animate", "<iframe",        "&#",
};

std::string in_lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_own(std::string_view target) {
  return target.starts_with("#") || target.starts_with("data:image/png") ||
         target.starts_with("data:image/jpeg");
}

// The first target of `opening` (href=, url() that is neither within the picture nor its own data.
std::optional<std::string> foreign_target(std::string_view text, std::string_view opening) {
  for (std::size_t at = text.find(opening); at != std::string_view::npos;
       at = text.find(opening, at + 1)) {
    std::string_view target = text.substr(at + opening.size());
    target.remove_prefix(std::min(target.find_first_not_of(" \t\r\n=\"'"), target.size()));
    if (!is_own(target)) {
      return std::string(
          target.substr(0, std::min<std::size_t>(target.find_first_of("\"')> "), 60)));
    }
  }
  return std::nullopt;
}

std::optional<std::string> danger_in_svg(const std::string& bytes) {
  const std::string text = in_lower_case(bytes);
  if (text.find('\0') != std::string::npos) {
    return "is not UTF-8 text";
  }
  for (const char* forbidden : forbidden_in_svg) {
    if (text.find(forbidden) != std::string::npos) {
      return fmt::format("contains '{}', which a document does not take in", forbidden);
    }
  }
  for (const char* opening : {"href", "url(", "src"}) {
    if (const auto target = foreign_target(text, opening)) {
      return fmt::format("refers to '{}', but a document fetches nothing; embed it", *target);
    }
  }
  for (std::size_t at = text.find(" on"); at != std::string::npos; at = text.find(" on", at + 1)) {
    const std::size_t end = text.find_first_not_of("abcdefghijklmnopqrstuvwxyz", at + 3);
    if (end != std::string::npos && text[end] == '=') {
      return "runs something on an event, which a document does not take in";
    }
  }
  return std::nullopt;
}

std::string type_of(const std::string& bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) {
    return "image/png";
  }
  if (bytes.starts_with("\xff\xd8\xff")) {
    return "image/jpeg";
  }
  return bytes.find("<svg") != std::string::npos ? "image/svg+xml" : "";
}

} // namespace

std::string base64(std::string_view bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes, as OpenSSL takes them
  const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                     // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
                                     reinterpret_cast<const unsigned char*>(bytes.data()),
                                     static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(std::max(length, 0)));
  return text;
}

std::string EmbeddedPicture::data_uri() const {
  return fmt::format("data:{};base64,{}", mime_type, base64(bytes));
}

Expected<EmbeddedPicture> read_picture(const std::filesystem::path& path) {
  DYNCAL_TRY(auto bytes, read_whole_file(path, max_picture_bytes));
  EmbeddedPicture picture{path.filename().string(), type_of(bytes), std::move(bytes)};
  if (picture.mime_type.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: is neither PNG, JPEG nor SVG", path.string()));
  }
  if (picture.mime_type == "image/svg+xml") {
    if (const auto danger = danger_in_svg(picture.bytes)) {
      return fail(ErrorCode::bad_file, fmt::format("{}: {}", path.string(), *danger));
    }
  }
  return picture;
}

} // namespace dyncal::inline views
