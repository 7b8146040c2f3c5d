#include "services/views/document/toml_comments.hpp"

#include <algorithm>
#include <array>

namespace dyncal::inline views {
namespace {

constexpr std::string_view blanks = " \t\r";

// The longest first, as one begins like the other.
constexpr std::array<std::string_view, 4> quotes{R"(""")", "'''", "\"", "'"};

std::string_view quote_at(std::string_view text) {
  for (const std::string_view quote : quotes) {
    if (text.starts_with(quote)) {
      return quote;
    }
  }
  return {};
}

// Where the string ends whose quotation mark begins `text`, behind the mark; else its whole length.
std::size_t end_of_string(std::string_view text, std::string_view quote) {
  const bool has_escapes = quote.front() == '"';
  const bool is_one_line = quote.size() == 1;
  for (std::size_t at = quote.size(); at < text.size(); ++at) {
    if (has_escapes && text[at] == '\\') {
      ++at;
    } else if (text.substr(at).starts_with(quote)) {
      return at + quote.size();
    } else if (is_one_line && text[at] == '\n') {
      return at;
    }
  }
  return text.size();
}

// Ends the line of `text` that begins there; one that held a comment alone goes.
void end_line(std::string& text, std::size_t begin, bool had_comment) {
  text.erase(text.find_last_not_of(blanks) + 1);
  const bool is_empty = text.size() <= begin;
  text.resize(is_empty ? begin : text.size());
  const bool follows_empty = text.empty() || text.ends_with("\n\n");
  if (!is_empty || (!had_comment && !follows_empty)) {
    text += '\n';
  }
}

} // namespace

std::string without_comments(std::string_view toml) {
  std::string text;
  std::size_t line_begin = 0;
  bool had_comment = false;
  for (std::size_t at = 0; at < toml.size();) {
    if (toml[at] == '#') {
      had_comment = true;
      at = std::min(toml.find('\n', at), toml.size());
    } else if (const auto quote = quote_at(toml.substr(at)); !quote.empty()) {
      const std::size_t length = end_of_string(toml.substr(at), quote);
      text += toml.substr(at, length);
      at += length;
    } else if (toml[at] == '\n') {
      end_line(text, line_begin, had_comment);
      line_begin = text.size();
      had_comment = false;
      ++at;
    } else {
      text += toml[at++];
    }
  }
  end_line(text, line_begin, true);
  return text.find_first_not_of(" \t\r\n") == std::string::npos ? "" : text;
}

} // namespace dyncal::inline views
