// A list of sensors as laboratories keep it in a spreadsheet, turned into sensor files: CSV with a
// head (csv_rows.hpp), one sensor a row.
//
//   serial, name, manufacturer, model     needed
//   electronic_model, electronic_serial, firmware, owner_identification, interval_months,
//   positive_direction                    as in [sensor] of a sensor file
//   customer, customer_city, customer_country
//                                         whom it belongs to; all three or none
//
// Fails (bad_file) with file, line and what is wrong: a column that is not known or missing, a row
// with another number of fields, a value that a sensor file cannot have, a serial number twice. Any
// thread.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "services/base/error.hpp"

namespace dyncal::inline views {

// The text of a sensor file for each row.
[[nodiscard]] Expected<std::vector<std::string>>
parse_sensor_list(std::string_view text, const std::filesystem::path& path);

} // namespace dyncal::inline views
