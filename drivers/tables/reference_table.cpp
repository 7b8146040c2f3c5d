#include "drivers/tables/reference_table.hpp"

#include <fmt/core.h>

#include "drivers/tables/spektra_table.hpp"
#include "drivers/tables/strict_table.hpp"

namespace dyncal::drivers::tables {
namespace {

std::optional<TableFormat> format_of(const std::vector<TableLine>& lines) {
  if (is_strict_table(lines)) {
    return TableFormat::ptb_csv;
  }
  if (is_spektra_csv(lines)) {
    return TableFormat::spektra_csv;
  }
  return is_spektra_prp(lines) ? std::optional(TableFormat::spektra_prp) : std::nullopt;
}

// The lines that are there do not rule out that the rest of it is still to be written.
bool may_lack_head(std::optional<TableFormat> format, const std::vector<TableLine>& lines) {
  if (!format) {
    return lines.size() < max_lines_of_head;
  }
  return *format == TableFormat::ptb_csv ? lines.size() < lines_of_strict_head
                                         : may_lack_spektra_head(lines);
}

Expected<std::vector<ReferenceTableRow>> read_rows(TableFormat format, const std::string& file,
                                                   const std::vector<TableLine>& lines) {
  switch (format) {
  case TableFormat::ptb_csv:
    return read_strict_table(file, lines);
  case TableFormat::spektra_csv:
    return read_spektra_csv(file, lines);
  case TableFormat::spektra_prp:
    break;
  }
  return read_spektra_prp(file, lines);
}

} // namespace

Expected<std::vector<ReferenceTableRow>> parse_reference_table(const std::string& file,
                                                               std::string_view text,
                                                               std::optional<TableFormat> format,
                                                               TableIs is) {
  const TableLines lines = lines_of(text);
  if (!format) {
    format = format_of(lines.lines);
  }
  if (is == TableIs::written_to && may_lack_head(format, lines.lines)) {
    return std::vector<ReferenceTableRow>{};
  }
  if (!format) {
    return refuse({file, 1}, "the file is no table of a calibration system",
                  fmt::format("'{}', or the names Frequency, Acceleration, Phase of a SPEKTRA "
                              "system, and behind them units",
                              names_of_strict_table));
  }
  DYNCAL_TRY(auto rows, read_rows(*format, file, lines.lines));
  if (is == TableIs::whole && lines.cut) {
    return refuse({file, lines.lines.size() + 1}, "the line has no end, as if the file was cut",
                  "a line end behind the last row (add it where the file is whole)");
  }
  if (is == TableIs::whole && rows.empty()) {
    return refuse({file, lines.lines.size() + 1}, "the file ends without a row", "rows");
  }
  return rows;
}

} // namespace dyncal::drivers::tables
