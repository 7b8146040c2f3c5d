// Texts of others (names in files, what instruments and programs on the network say of themselves)
// as they may be written into JSON and onto a terminal. Anyone who writes Latin-1, "Br\xfcel", or
// anything else that is not UTF-8 (RFC 3629) costs no result and steers no terminal; and anyone who
// writes a book, forges no line and hides none. one_line() stands at every door to people: log,
// last line of a program, tables, page.
//
// Plain functions, any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace dyncal::inline base {

// How many bytes of `text` are its first letter in UTF-8; 0: it begins with none.
[[nodiscard]] inline std::size_t first_letter_bytes(std::string_view text) {
  struct Form {
    std::size_t bytes;
    unsigned mask;
    unsigned lead;
    std::uint32_t least; // shorter forms of a letter are not valid
  };
  constexpr Form forms[] = {{1, 0x80, 0x00, 0x0},
                            {2, 0xe0, 0xc0, 0x80},
                            {3, 0xf0, 0xe0, 0x800},
                            {4, 0xf8, 0xf0, 0x10000}};
  for (const Form& form : forms) {
    const auto lead = text.empty() ? 0xffU : static_cast<unsigned char>(text.front());
    if ((lead & form.mask) != form.lead || text.size() < form.bytes) {
      continue;
    }
    std::uint32_t letter = lead & ~form.mask;
    bool continues = true;
    for (const char next : text.substr(1, form.bytes - 1)) {
      const auto byte = static_cast<unsigned char>(next);
      continues = continues && (byte & 0xc0U) == 0x80U;
      letter = (letter << 6U) | (byte & 0x3fU);
    }
    const bool is_surrogate = letter >= 0xd800 && letter <= 0xdfff;
    return continues && letter >= form.least && letter <= 0x10ffff && !is_surrogate ? form.bytes
                                                                                    : 0;
  }
  return 0;
}

// U+FFFD in place of every byte that is not of a letter in UTF-8.
[[nodiscard]] inline std::string valid_utf8(std::string_view text) {
  std::string valid;
  valid.reserve(text.size());
  while (!text.empty()) {
    const std::size_t bytes = first_letter_bytes(text);
    valid += bytes == 0 ? "\xef\xbf\xbd" : text.substr(0, bytes);
    text.remove_prefix(bytes == 0 ? 1 : bytes);
  }
  return valid;
}

// U+2028 to U+202E and U+2066 to U+2069: they break a line, or turn the order of what follows.
[[nodiscard]] inline bool turns_or_breaks(std::string_view letter) {
  const auto last = letter.size() >= 3 ? static_cast<unsigned char>(letter[2]) : 0U;
  return (letter.starts_with("\xe2\x80") && last >= 0xa8 && last <= 0xae) ||
         (letter.starts_with("\xe2\x81") && last >= 0xa6 && last <= 0xa9);
}

// The same, and '?' in place of control characters: one line that a terminal only shows.
[[nodiscard]] inline std::string printable(std::string_view text) {
  std::string shown = valid_utf8(text);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const auto byte = static_cast<unsigned char>(shown[i]);
    const auto next = i + 1 < shown.size() ? static_cast<unsigned char>(shown[i + 1]) : 0U;
    if (byte < 0x20 || byte == 0x7f) {
      shown[i] = '?';
    } else if (byte == 0xc2 && next < 0xa0) {
      shown.replace(i, 2, "?"); // U+0080 to U+009F
    } else if (byte == 0xe2 && turns_or_breaks(std::string_view(shown).substr(i, 3))) {
      shown.replace(i, 3, "?");
    }
  }
  return shown;
}

// Longer than any sentence of ours.
inline constexpr std::size_t max_line_bytes = 1000;

// The same, and not longer than max_bytes: of more, the beginning and, as a sentence of ours often
// ends with the remedy, the end. REQUIRES: max_bytes >= 32
[[nodiscard]] inline std::string one_line(std::string_view text,
                                          std::size_t max_bytes = max_line_bytes) {
  constexpr std::string_view left_out = " [...] ";
  std::string shown = printable(text);
  if (shown.size() <= max_bytes) {
    return shown;
  }
  const auto continues_letter = [&](std::size_t at) {
    return (static_cast<unsigned char>(shown[at]) & 0xc0U) == 0x80U;
  };
  std::size_t begin = (max_bytes - left_out.size()) * 2 / 3;
  std::size_t end = shown.size() - (max_bytes - left_out.size() - begin);
  while (begin > 0 && continues_letter(begin)) {
    --begin;
  }
  while (end < shown.size() && continues_letter(end)) {
    ++end;
  }
  return shown.replace(begin, end - begin, left_out);
}

} // namespace dyncal::inline base
