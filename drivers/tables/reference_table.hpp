// The table of an analogue calibration system out of its file. README.md has the formats.
//
// The format is known by what the first lines are, or given. Amplitudes above 0 in m/s^2,
// frequencies above 0 in Hz, phases in degrees; rows in the order of the file. Fails (malformed)
// with file, line, column and what was expected there: a file of another kind, a row with too few
// cells, a number that is none, another unit; where the file is said to be whole, a last line
// without an end, and a file without rows. Any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/error.hpp"
#include "drivers/tables/reference_table_row.hpp"

namespace dyncal::drivers::tables {

enum class TableFormat { ptb_csv, spektra_csv, spektra_prp };
[[nodiscard]] constexpr const char* to_string(TableFormat format) {
  return format == TableFormat::ptb_csv       ? "ptb-csv"
         : format == TableFormat::spektra_csv ? "spektra-csv"
                                              : "spektra-prp";
}

enum class TableIs {
  whole,
  written_to // its end may be half a line; nothing of its head need be there yet
};

// `file`: how messages name it.
[[nodiscard]] Expected<std::vector<ReferenceTableRow>>
parse_reference_table(const std::string& file, std::string_view text,
                      std::optional<TableFormat> format = {}, TableIs is = TableIs::whole);

} // namespace dyncal::drivers::tables
