// The strict CSV of PTB and of the public receiver (README.md, `ptb-csv`). `lines` have ends. Fails
// as reference_table.hpp says. Any thread.
#pragma once

#include <string>
#include <vector>

#include "drivers/error.hpp"
#include "drivers/tables/reference_table_row.hpp"
#include "drivers/tables/table_text.hpp"

namespace dyncal::drivers::tables {

inline constexpr const char* names_of_strict_table =
    "loop;frequency;ex_amp;ex_amp_std;phase;phase_std";
inline constexpr std::size_t lines_of_strict_head = 3;

[[nodiscard]] bool is_strict_table(const std::vector<TableLine>& lines);
[[nodiscard]] Expected<std::vector<ReferenceTableRow>>
read_strict_table(const std::string& file, const std::vector<TableLine>& lines);

} // namespace dyncal::drivers::tables
