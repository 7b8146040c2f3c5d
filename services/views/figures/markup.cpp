#include "services/views/figures/markup.hpp"

#include <algorithm>

#include "services/base/printable_text.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::string_view replacement = "\xef\xbf\xbd"; // U+FFFD

bool is_control(std::string_view letter) {
  const auto first = static_cast<unsigned char>(letter.front());
  return (first < 0x20 && first != '\n' && first != '\t') || first == 0x7f ||
         (first == 0xc2 && static_cast<unsigned char>(letter[1]) < 0xa0);
}

} // namespace

std::string document_text(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t bytes = first_letter_bytes(text);
    const std::string_view letter = text.substr(0, bytes);
    result += bytes == 0 || is_control(letter) || turns_or_breaks(letter) ? replacement : letter;
    text.remove_prefix(std::max<std::size_t>(bytes, 1));
  }
  return result;
}

std::string escaped(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : document_text(text)) {
    switch (c) {
    case '&':
      result += "&amp;";
      break;
    case '<':
      result += "&lt;";
      break;
    case '>':
      result += "&gt;";
      break;
    case '"':
      result += "&quot;";
      break;
    case '\'':
      result += "&#39;";
      break;
    default:
      result += c;
    }
  }
  return result;
}

} // namespace dyncal::inline views
