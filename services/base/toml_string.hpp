// A text as TOML writes it: a basic string in its quotation marks. Plain function; any thread.
#pragma once

#include <string>

#include <fmt/format.h>

namespace dyncal::inline base {

[[nodiscard]] inline std::string toml_string(const std::string& text) {
  std::string escaped = "\"";
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '"' || letter == '\\') {
      escaped += '\\';
      escaped += letter;
    } else if (code < 0x20 || code == 0x7f) {
      escaped += fmt::format("\\u{:04x}", code);
    } else {
      escaped += letter;
    }
  }
  return escaped + '"';
}

} // namespace dyncal::inline base
