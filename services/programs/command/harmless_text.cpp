#include "services/programs/command/harmless_text.hpp"

#include <algorithm>
#include <cstdint>

#include "services/base/printable_text.hpp"

namespace dyncal::inline programs {
namespace {

bool is_continuation(char byte) {
  return (static_cast<unsigned char>(byte) & 0xc0U) == 0x80U;
}

// Latin, Greek and what is among them: one column each.
bool is_one_column(std::uint32_t letter) {
  return letter >= 0xa0 && letter <= 0x3ff && (letter < 0x300 || letter > 0x36f) && letter != 0xad;
}

} // namespace

std::string harmless(std::string_view text_of_others) {
  const std::string text = one_line(text_of_others);
  std::string shown;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x80) {
      shown += byte < 0x20 || byte == 0x7f ? '?' : static_cast<char>(byte);
      continue;
    }
    const bool pair =
        (byte & 0xe0U) == 0xc0U && i + 1 < text.size() && is_continuation(text[i + 1]);
    const std::uint32_t letter =
        pair ? ((byte & 0x1fU) << 6U) | (static_cast<unsigned char>(text[i + 1]) & 0x3fU) : 0U;
    if (pair && is_one_column(letter)) {
      shown.append(text, i, 2);
    } else {
      shown += '?';
    }
    while (i + 1 < text.size() && is_continuation(text[i + 1])) {
      ++i;
    }
  }
  return shown;
}

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char byte) { return !is_continuation(byte); }));
}

std::string in_columns(const std::string& text, std::size_t columns) {
  const std::size_t width = columns_of(text);
  if (width <= columns) {
    return text + std::string(columns - width, ' ');
  }
  const std::string end(std::min<std::size_t>(columns, 2), '.');
  std::string shown;
  std::size_t taken = 0;
  for (const char byte : text) {
    if (!is_continuation(byte) && taken++ == columns - end.size()) {
      break;
    }
    shown += byte;
  }
  return shown + end;
}

} // namespace dyncal::inline programs
