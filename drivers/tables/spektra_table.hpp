// The two tables that SPEKTRA's systems export (README.md, `spektra-csv` and `spektra-prp`), one
// loop a file. `lines` have ends. Fails as reference_table.hpp says. Any thread.
#pragma once

#include <string>
#include <vector>

#include "drivers/error.hpp"
#include "drivers/tables/reference_table_row.hpp"
#include "drivers/tables/table_text.hpp"

namespace dyncal::drivers::tables {

inline constexpr std::size_t max_lines_of_head = 60; // the names of a prp file stand on its 18th

// Names, or the units behind them, may still be written.
[[nodiscard]] bool may_lack_spektra_head(const std::vector<TableLine>& lines);

[[nodiscard]] bool is_spektra_csv(const std::vector<TableLine>& lines);
[[nodiscard]] Expected<std::vector<ReferenceTableRow>>
read_spektra_csv(const std::string& file, const std::vector<TableLine>& lines);

[[nodiscard]] bool is_spektra_prp(const std::vector<TableLine>& lines);
[[nodiscard]] Expected<std::vector<ReferenceTableRow>>
read_spektra_prp(const std::string& file, const std::vector<TableLine>& lines);

} // namespace dyncal::drivers::tables
