#include "drivers/tables/table_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/base/text.hpp"

namespace dyncal::drivers::tables {
namespace {

constexpr std::size_t longest_quote = 40;

// Of a file of another encoding nothing is printed that a terminal may take as a command.
std::string quote(std::string_view text) {
  std::string result = "'";
  for (const char c : text.substr(0, longest_quote)) {
    result += c >= ' ' && c <= '~' ? c : '?';
  }
  return result + (text.size() > longest_quote ? "...'" : "'");
}

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
}

} // namespace

TableLines lines_of(std::string_view text) {
  TableLines result;
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    const std::string_view line = text.substr(0, end);
    result.lines.push_back(
        {result.lines.size() + 1, line.ends_with('\r') ? line.substr(0, line.size() - 1) : line});
    text.remove_prefix(end + 1);
  }
  result.cut = !trimmed(text).empty();
  return result;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (std::size_t end = line.find(separator); end != std::string_view::npos;
       end = line.find(separator)) {
    cells.push_back(trimmed(line.substr(0, end)));
    line.remove_prefix(end + 1);
  }
  cells.push_back(trimmed(line));
  return cells;
}

std::string letters_of(std::string_view name) {
  std::string letters;
  for (const char c : name) {
    if (is_letter_or_digit(lower(c))) {
      letters += lower(c);
    }
  }
  return letters;
}

tl::unexpected<Error> refuse(const TablePlace& place, const std::string& what,
                             const std::string& expected) {
  const std::string column = place.column > 0 ? fmt::format(", column {}", place.column) : "";
  return fail(ErrorCode::malformed, fmt::format("{}: line {}{}: {}; expected {}", place.file,
                                                place.line, column, what, expected));
}

TableColumns::TableColumns(const std::string& file, std::size_t line,
                           std::vector<std::string_view> names, char decimal_point)
    : file_(file), line_(line), names_(names.begin(), names.end()), decimal_point_(decimal_point) {}

std::optional<std::size_t> TableColumns::find_if_there(std::string_view name) const {
  const auto found = std::ranges::find_if(
      names_, [&](const std::string& one) { return letters_of(one) == letters_of(name); });
  return found == names_.end() ? std::nullopt : std::optional<std::size_t>(found - names_.begin());
}

Expected<std::size_t> TableColumns::find(std::string_view name) const {
  if (const auto column = find_if_there(name)) {
    return *column;
  }
  std::vector<std::string> there;
  for (const std::string& one : names_) {
    there.push_back(quote(one));
  }
  return refuse({file_, line_}, fmt::format("there are the columns {}", fmt::join(there, ", ")),
                fmt::format("one that is named '{}'", name));
}

Expected<double> TableColumns::number(std::size_t line, const std::vector<std::string_view>& row,
                                      std::size_t column) const {
  const std::string_view cell = row[column];
  std::string text(cell.starts_with('+') ? cell.substr(1) : cell);
  const bool other_point = decimal_point_ != '.' && text.find('.') != std::string::npos;
  std::ranges::replace(text, decimal_point_, '.');
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (other_point || status != std::errc() || end != text.data() + text.size() ||
      !std::isfinite(value)) {
    return refuse(place(line, column), quote(cell),
                  fmt::format("a number with a decimal {} for '{}'",
                              decimal_point_ == ',' ? "comma" : "point", names_[column]));
  }
  return value;
}

bool is_empty_or_comment(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.starts_with('#');
}

Expected<void> require_above_0(const TablePlace& place, double value) {
  return value > 0.0 ? Expected<void>{}
                     : refuse(place, fmt::format("{}", value), "a number above 0");
}

Expected<void> require_acceleration(const TablePlace& place, std::string_view unit) {
  const std::string letters = letters_of(unit); // "m/s^2", "m/s2 Peak", "m/s" and a superscript 2
  const bool superscript = unit.find('\xb2') != std::string_view::npos;
  if (letters == "ms2" || letters == "ms2peak" ||
      (superscript && (letters == "ms" || letters == "mspeak"))) {
    return {};
  }
  return refuse(place, "the unit " + quote(unit), "m/s^2 (peak)");
}

Expected<void> require_degrees(const TablePlace& place, std::string_view unit) {
  const std::string letters = letters_of(unit);
  if (letters == "deg" || letters == "degree" || letters == "degrees" ||
      unit.find('\xb0') != std::string_view::npos) {
    return {};
  }
  return refuse(place, "the unit " + quote(unit), "deg");
}

Expected<void> require_hertz(const TablePlace& place, std::string_view unit) {
  return letters_of(unit) == "hz" ? Expected<void>{}
                                  : refuse(place, "the unit " + quote(unit), "Hz");
}

} // namespace dyncal::drivers::tables
