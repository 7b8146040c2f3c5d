#include "services/base/csv_rows.hpp"

#include <algorithm>

namespace dyncal::inline base {
namespace {

constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  return begin == std::string::npos ? ""
                                    : text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

// Takes one record from the front of `text`, which may go over several lines.
std::vector<std::string> take_record(std::string_view& text, char separator, std::size_t& lines) {
  std::vector<std::string> fields(1);
  bool is_quoted = false;
  std::size_t place = 0;
  for (; place < text.size(); ++place) {
    const char letter = text[place];
    lines += letter == '\n' ? 1U : 0U;
    if (letter == '"') {
      const bool is_doubled = is_quoted && place + 1 < text.size() && text[place + 1] == '"';
      if (is_doubled) {
        fields.back() += text[++place];
      } else {
        is_quoted = !is_quoted;
      }
    } else if (!is_quoted && letter == '\n') {
      ++place;
      break;
    } else if (!is_quoted && letter == separator) {
      fields.emplace_back();
    } else if (letter != '\r') {
      fields.back() += letter;
    }
  }
  text.remove_prefix(place);
  std::ranges::transform(fields, fields.begin(), trimmed);
  return fields;
}

} // namespace

char csv_separator(std::string_view line) {
  for (const char candidate : {';', '\t'}) {
    if (line.find(candidate) != std::string_view::npos) {
      return candidate;
    }
  }
  return ',';
}

std::vector<std::string> csv_fields(std::string_view line, char separator) {
  std::size_t lines = 0;
  return take_record(line, separator, lines);
}

std::string_view without_byte_order_mark(std::string_view text) {
  return text.substr(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0);
}

CsvRows csv_rows(std::string_view text) {
  text = without_byte_order_mark(text);
  const char separator = csv_separator(text.substr(0, text.find('\n')));
  std::size_t line = 0;
  CsvRows table{.head = take_record(text, separator, line), .rows = {}};
  while (!text.empty()) {
    CsvRow row{.line = line + 1, .fields = {}};
    const std::vector<std::string> fields = take_record(text, separator, line);
    row.fits = fields.size() == table.head.size();
    for (std::size_t i = 0; i < std::min(fields.size(), table.head.size()); ++i) {
      if (!fields[i].empty()) {
        row.fields[table.head[i]] = fields[i];
      }
    }
    if (!row.fields.empty()) {
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

} // namespace dyncal::inline base
