#include "drivers/can/dbc/dbc_scanner.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include "drivers/can/dbc/dbc_keywords.hpp"

namespace dyncal::drivers::can {

namespace {

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f' || c == '\0';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool ends_name(char c) {
  return is_space(c) || std::string_view(":;,|@()[]\"").find(c) != std::string_view::npos;
}

} // namespace

void DbcScanner::skip_space() {
  for (; at_ < text_.size(); ++at_) {
    if (text_.substr(at_).starts_with("//")) {
      skip_line();
    }
    if (at_ == text_.size() || !is_space(text_[at_])) {
      return;
    }
    if (text_[at_] == '\n') {
      ++line_;
    }
  }
}

bool DbcScanner::at_end() {
  skip_space();
  return at_ == text_.size();
}

bool DbcScanner::same_line() {
  skip_space();
  return line_ == last_line_ && at_ < text_.size();
}

bool DbcScanner::next_is(char character) {
  skip_space();
  return at_ < text_.size() && text_[at_] == character;
}

bool DbcScanner::next_begins_statement() {
  skip_space();
  return statement_begins_at(at_);
}

bool DbcScanner::character(char wanted) {
  if (!next_is(wanted)) {
    return false;
  }
  ++at_;
  last_line_ = line_;
  return true;
}

std::optional<std::string> DbcScanner::name() {
  skip_space();
  const std::size_t begin = at_;
  while (at_ < text_.size() && !ends_name(text_[at_])) {
    ++at_;
  }
  if (at_ == begin) {
    return std::nullopt;
  }
  last_line_ = line_;
  return std::string(text_.substr(begin, at_ - begin));
}

std::optional<std::uint64_t> DbcScanner::unsigned_integer() {
  skip_space();
  std::uint64_t value = 0;
  const char* begin = text_.data() + at_;
  const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
  if (error != std::errc()) {
    return std::nullopt;
  }
  at_ += static_cast<std::size_t>(end - begin);
  last_line_ = line_;
  return value;
}

std::optional<double> DbcScanner::number() {
  skip_space();
  std::size_t begin = at_;
  if (begin < text_.size() && text_[begin] == '+') {
    ++begin;
  }
  const bool digits_follow = begin < text_.size() &&
                             (is_digit(text_[begin]) || text_[begin] == '-' || text_[begin] == '.');
  if (!digits_follow) {
    return std::nullopt;
  }
  double value = 0.0;
  const auto [end, error] =
      std::from_chars(text_.data() + begin, text_.data() + text_.size(), value);
  if (error != std::errc() || !std::isfinite(value)) {
    return std::nullopt;
  }
  at_ = static_cast<std::size_t>(end - text_.data());
  last_line_ = line_;
  return value;
}

std::optional<double> DbcScanner::limit() {
  if (const auto value = number()) {
    if (at_ < text_.size() && text_[at_] == '#') { // 1.#INF, as a library of C writes it
      name();
      return std::numeric_limits<double>::infinity();
    }
    return value;
  }
  skip_space();
  const std::size_t begin = at_ + (at_ < text_.size() && text_[at_] == '+' ? 1 : 0);
  double value = 0.0;
  const auto [end, error] =
      std::from_chars(text_.data() + begin, text_.data() + text_.size(), value);
  if (error == std::errc::invalid_argument) {
    return std::nullopt;
  }
  at_ = static_cast<std::size_t>(end - text_.data());
  last_line_ = line_;
  return std::numeric_limits<double>::infinity();
}

bool DbcScanner::statement_begins_at(std::size_t at) const {
  constexpr std::size_t longest = 512; // of a keyword with id and names, so that a string of many
                                       // lines is not read once for each of them
  return begins_statement(text_.substr(at, longest));
}

std::optional<std::string> DbcScanner::string() {
  skip_space();
  const Place before = place();
  if (!character('"')) {
    return std::nullopt;
  }
  std::string content;
  bool holds_statement = false;
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (c == '\\' && at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
      // A backslash at the end of a string is a backslash: what ends a statement or separates
      // follows the quote.
      const std::size_t behind = at_ + 2;
      const bool ends_there =
          behind < text_.size() && (text_[behind] == ';' || text_[behind] == ',' ||
                                    text_[behind] == '\r' || text_[behind] == '\n');
      content += ends_there ? '\\' : '"';
      if (!ends_there) {
        ++at_;
      }
      continue;
    }
    if (c == '"') {
      ++at_;
      last_line_ = line_;
      if (holds_statement && at_ < text_.size() && !is_space(text_[at_]) &&
          std::string_view(";,|").find(text_[at_]) == std::string_view::npos) {
        broken_string_ = broken_string_.value_or(before.line);
      }
      return content;
    }
    if (c == '\n') {
      ++line_;
      holds_statement = holds_statement || statement_begins_at(at_ + 1);
    }
    content += c;
  }
  broken_string_ = broken_string_.value_or(before.line);
  go_back(before);
  return std::nullopt;
}

DbcScanner::StatementEnd DbcScanner::skip_statement() {
  while (!at_end()) {
    if (!same_line() && next_begins_statement()) {
      return StatementEnd::next_statement;
    }
    if (next_is('"')) {
      if (!string()) {
        at_ = text_.size(); // broken_string() tells
      }
      continue;
    }
    last_line_ = line_;
    if (text_[at_++] == ';') {
      return StatementEnd::semicolon;
    }
  }
  return StatementEnd::file;
}

void DbcScanner::skip_line() {
  while (at_ < text_.size() && text_[at_] != '\n') {
    ++at_;
  }
}

void DbcScanner::go_back(Place place) {
  at_ = place.at;
  line_ = place.line;
  last_line_ = place.last_line;
}

std::string DbcScanner::next_text() {
  if (at_end()) {
    return "the end of the file";
  }
  std::size_t end = at_;
  while (end < text_.size() && end - at_ < 12 && text_[end] != '\n' && text_[end] != '\r') {
    ++end;
  }
  return "'" + std::string(text_.substr(at_, end - at_)) + "'";
}

} // namespace dyncal::drivers::can
