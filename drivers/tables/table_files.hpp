// The files of a table: one with all loops, one a loop, or a folder that holds one a loop.
//
// Of a folder all files are read in the order of their names, but hidden ones. Fails (not_found)
// with a file that cannot be read, is no file, or is above 16 MB, and as reference_table.hpp does.
// Any thread.
#pragma once

#include <vector>

#include "drivers/error.hpp"
#include "drivers/tables/table_match.hpp"
#include "drivers/tables/table_settings.hpp"

namespace dyncal::drivers::tables {

// `written_to`: what is not there yet counts as empty.
[[nodiscard]] Expected<std::vector<TableFile>> read_table_files(const TableSettings& settings,
                                                                TableIs is = TableIs::whole);

} // namespace dyncal::drivers::tables
