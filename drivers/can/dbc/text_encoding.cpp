#include "drivers/can/dbc/text_encoding.hpp"

#include <array>
#include <cstdint>

namespace dyncal::drivers::can {

namespace {

// Windows-1252, bytes 0x80 ... 0x9f; the others equal their code points.
constexpr std::array<char16_t, 32> high_controls = {
    0x20ac, 0xfffd, 0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160,
    0x2039, 0x0152, 0xfffd, 0x017d, 0xfffd, 0xfffd, 0x2018, 0x2019, 0x201c, 0x201d, 0x2022,
    0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0xfffd, 0x017e, 0x0178};

std::size_t continuation_bytes(std::uint8_t lead) {
  if (lead >= 0xc2 && lead <= 0xdf) {
    return 1;
  }
  if ((lead & 0xf0U) == 0xe0) {
    return 2;
  }
  if (lead >= 0xf0 && lead <= 0xf4) {
    return 3;
  }
  return 0;
}

bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    const auto lead = static_cast<std::uint8_t>(text[at]);
    if (lead < 0x80) {
      continue;
    }
    const std::size_t more = continuation_bytes(lead);
    if (more == 0 || at + more >= text.size()) {
      return false;
    }
    for (std::size_t i = 0; i < more; ++i) {
      if ((static_cast<std::uint8_t>(text[++at]) & 0xc0U) != 0x80) {
        return false;
      }
    }
  }
  return true;
}

void append_utf8(std::string& out, char16_t code) {
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xc0 | (code >> 6));
    out += static_cast<char>(0x80 | (code & 0x3f));
  } else {
    out += static_cast<char>(0xe0 | (code >> 12));
    out += static_cast<char>(0x80 | ((code >> 6) & 0x3f));
    out += static_cast<char>(0x80 | (code & 0x3f));
  }
}

} // namespace

std::string to_utf8(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) {
    text.remove_prefix(3);
  }
  if (is_utf8(text)) {
    return std::string(text);
  }
  std::string out;
  out.reserve(text.size() + text.size() / 8);
  for (const char character : text) {
    const auto byte = static_cast<std::uint8_t>(character);
    append_utf8(out, byte >= 0x80 && byte < 0xa0 ? high_controls[byte - 0x80U]
                                                 : static_cast<char16_t>(byte));
  }
  return out;
}

} // namespace dyncal::drivers::can
