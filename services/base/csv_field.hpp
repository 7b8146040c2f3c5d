// A text as a field of a CSV file (RFC 4180): in quotation marks where it would be taken for
// several fields or lines, whichever of comma and semicolon separates them. Plain function; any
// thread.
#pragma once

#include <string>

namespace dyncal::inline base {

[[nodiscard]] inline std::string csv_field(const std::string& text) {
  if (text.find_first_of(",;\"\n\r") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char letter : text) {
    quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  }
  return quoted + '"';
}

} // namespace dyncal::inline base
