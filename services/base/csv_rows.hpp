// A small table as spreadsheets save it: CSV with a head, separated by commas, semicolons or tabs,
// fields in quotation marks where they hold one (RFC 4180), with or without a byte order mark.
// Empty lines are passed over. Plain functions; any thread.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace dyncal::inline base {

struct CsvRow {
  std::size_t line = 0;
  std::map<std::string, std::string> fields; // by the head; empty ones are left out
  bool fits = true;                          // as many fields as the head has names
};

struct CsvRows {
  std::vector<std::string> head;
  std::vector<CsvRow> rows;
};

[[nodiscard]] CsvRows csv_rows(std::string_view text);

// Of one line: its separator, a semicolon or tab where there is one, since commas may be decimal
// ones; and its fields without spaces around them.
[[nodiscard]] char csv_separator(std::string_view line);
[[nodiscard]] std::vector<std::string> csv_fields(std::string_view line, char separator);
// Without a byte order mark.
[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text);

} // namespace dyncal::inline base
