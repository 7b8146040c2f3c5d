// A small table as spreadsheets save it: CSV with a head, separated by commas, semicolons or tabs,
// fields in quotation marks where they hold one (RFC 4180), with or without a byte order mark.
// Empty lines are passed over. Plain function; any thread.
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

} // namespace dyncal::inline base
