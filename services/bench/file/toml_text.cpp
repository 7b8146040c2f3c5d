#include "services/bench/file/toml_text.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

#include <fmt/core.h>
#include <toml++/toml.h>

namespace dyncal::inline bench {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

// Behind the string that begins at `at` with a quotation mark; where it does not end: behind its
// line, or the text.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string three(3, quote);
  const bool is_long = text.substr(at, 3) == three;
  const std::string_view closing =
      is_long ? std::string_view(three) : std::string_view(three).substr(2);
  std::size_t end = at + closing.size();
  while (end < text.size() && text.substr(end, closing.size()) != closing) {
    if (!is_long && text[end] == '\n') {
      return end;
    }
    end += quote == '"' && text[end] == '\\' ? 2 : 1;
  }
  end += closing.size();
  // Up to two quotation marks may stand before the three that close it.
  for (int more = 0; is_long && more < 2 && end < text.size() && text[end] == quote; ++more) {
    ++end;
  }
  return std::min(end, text.size());
}

// The line, from 1, with a letter that may stand in strings and comments alone.
std::optional<std::size_t> line_with_foreign_letter(std::string_view text) {
  std::size_t at = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
  while (at < text.size()) {
    const char letter = text[at];
    if (static_cast<unsigned char>(letter) >= 0x80) {
      return 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + at, '\n'));
    }
    if (letter == '"' || letter == '\'') {
      at = end_of_string(text, at);
    } else if (letter == '#') {
      at = std::min(text.find('\n', at), text.size());
    } else {
      ++at;
    }
  }
  return std::nullopt;
}

} // namespace

tl::expected<toml::table, BenchProblem> parse_toml(std::string_view text,
                                                   const std::filesystem::path& path) {
  const auto refused = [&](std::size_t line, std::string_view reason) {
    return tl::unexpected(
        BenchProblem{path.string(), line, "", fmt::format("not valid TOML: {}", reason)});
  };
  if (const auto line = line_with_foreign_letter(text)) {
    return refused(*line, "outside of quotation marks and comments only the letters A to Z and a "
                          "to z, digits and signs may stand; put quotation marks around the rest");
  }
  try {
    return toml::parse(text, path.string());
  } catch (const toml::parse_error& error) {
    return refused(error.source().begin.line, error.description());
  }
}

} // namespace dyncal::inline bench
