#include "services/views/spreadsheet/means_csv.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "services/base/csv_field.hpp"

namespace dyncal::inline views {
namespace {

std::string cell_text(const TableCell& cell, CsvForm form) {
  if (const auto* text = std::get_if<std::string>(&cell)) {
    return csv_field(*text);
  }
  const double value = std::get<NumberCell>(cell).value;
  if (!std::isfinite(value)) {
    return "";
  }
  std::string text = fmt::format("{}", value);
  if (form == CsvForm::decimal_comma) {
    std::ranges::replace(text, '.', ',');
  }
  return text;
}

} // namespace

std::string csv_of(const MeansTable& table, CsvForm form) {
  const bool comma = form == CsvForm::decimal_comma;
  const char* const separator = comma ? ";" : ",";
  std::string csv = comma ? "\xEF\xBB\xBF" : "";
  for (std::size_t i = 0; i < table.head.size(); ++i) {
    csv += (i > 0 ? separator : "") + table.head[i];
  }
  csv += "\r\n"; // RFC 4180
  for (const std::vector<TableCell>& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      csv += (i > 0 ? separator : "") + cell_text(row[i], form);
    }
    csv += "\r\n";
  }
  return csv;
}

} // namespace dyncal::inline views
