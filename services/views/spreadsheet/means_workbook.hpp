// Means as a workbook (XLSX, by libxlsxwriter): the sheet "means", whose numbers have every digit
// and are shown with those that U allows, and the sheet "run", which says whose they are. Texts
// stay texts: none becomes a formula.
//
// Fails (bad_file) when the file cannot be written; (bad_argument) in a build without the library.
// Any thread.
#pragma once

#include <filesystem>

#include "services/base/error.hpp"
#include "services/views/spreadsheet/means_table.hpp"

namespace dyncal::inline views {

[[nodiscard]] Expected<void> write_workbook(const std::filesystem::path& path,
                                            const StoredResult& result);

} // namespace dyncal::inline views
