// Means as CSV: with commas and decimal points, as programs read it, or with semicolons, decimal
// commas and a byte order mark, as Excel does where the comma is that of the decimals. Numbers have
// every digit; what is not known is empty. Plain function; any thread.
#pragma once

#include <string>

#include "services/views/spreadsheet/means_table.hpp"

namespace dyncal::inline views {

enum class CsvForm { decimal_point, decimal_comma };

[[nodiscard]] std::string csv_of(const MeansTable& table, CsvForm form);

} // namespace dyncal::inline views
