// Small functions on text that more than one room needs. Pure functions; any thread.
#pragma once

#include <cstddef>
#include <string_view>

namespace dyncal {

// Without the blanks, tabs and line ends around it. A view into `text`.
[[nodiscard]] inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view white_space = " \t\r\n";
  const std::size_t first = text.find_first_not_of(white_space);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(white_space) - first + 1);
}

} // namespace dyncal
