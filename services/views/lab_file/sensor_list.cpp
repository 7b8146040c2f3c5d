#include "services/views/lab_file/sensor_list.hpp"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/csv_rows.hpp"
#include "services/base/toml_string.hpp"
#include "services/views/lab_file/sensor_file.hpp"

namespace dyncal::inline views {
namespace {

struct Column {
  std::string_view name;
  bool is_needed = false;
};

constexpr std::array sensor_columns{Column{"serial", true},       Column{"name", true},
                                    Column{"manufacturer", true}, Column{"model", true},
                                    Column{"electronic_model"},   Column{"electronic_serial"},
                                    Column{"firmware"},           Column{"owner_identification"},
                                    Column{"interval_months"},    Column{"positive_direction"}};

struct CustomerColumn {
  std::string_view name;
  std::string_view key; // in [customer]
};

constexpr std::array customer_columns{CustomerColumn{"customer", "name"},
                                      CustomerColumn{"customer_city", "city"},
                                      CustomerColumn{"customer_country", "country"}};

bool is_digit(char letter) {
  return letter >= '0' && letter <= '9';
}

bool is_known(const std::string& name) {
  return std::ranges::find(sensor_columns, name, &Column::name) != sensor_columns.end() ||
         std::ranges::find(customer_columns, name, &CustomerColumn::name) != customer_columns.end();
}

tl::unexpected<Error> refusal(const std::filesystem::path& path, std::size_t line,
                              const std::string& what) {
  return fail(ErrorCode::bad_file, fmt::format("{}:{}: {}", path.string(), line, what));
}

Expected<void> check_head(const CsvRows& table, const std::filesystem::path& path) {
  for (const std::string& name : table.head) {
    if (!is_known(name)) {
      std::vector<std::string_view> names;
      std::ranges::transform(sensor_columns, std::back_inserter(names), &Column::name);
      std::ranges::transform(customer_columns, std::back_inserter(names), &CustomerColumn::name);
      return refusal(
          path, 1,
          fmt::format("column '{}' is not known; columns are {}", name, fmt::join(names, ", ")));
    }
  }
  for (const Column& column : sensor_columns) {
    if (column.is_needed && std::ranges::find(table.head, column.name) == table.head.end()) {
      return refusal(path, 1, fmt::format("column '{}' is missing", column.name));
    }
  }
  return {};
}

std::string toml_of(const CsvRow& row) {
  std::string text = "[sensor]\n";
  for (const Column& column : sensor_columns) {
    const auto field = row.fields.find(std::string(column.name));
    if (field != row.fields.end()) {
      const bool is_number = column.name == "interval_months";
      text += fmt::format("{} = {}\n", column.name,
                          is_number ? field->second : toml_string(field->second));
    }
  }
  std::string customer;
  for (const CustomerColumn& column : customer_columns) {
    const auto field = row.fields.find(std::string(column.name));
    if (field != row.fields.end()) {
      customer += fmt::format("{} = {}\n", column.key, toml_string(field->second));
    }
  }
  return customer.empty() ? text : text + "\n[customer]\n" + customer;
}

} // namespace

Expected<std::vector<std::string>> parse_sensor_list(std::string_view text,
                                                     const std::filesystem::path& path) {
  const CsvRows table = csv_rows(text);
  DYNCAL_TRY(check_head(table, path));
  std::vector<std::string> files;
  std::set<std::string> serials;
  for (const CsvRow& row : table.rows) {
    if (!row.fits) {
      return refusal(path, row.line,
                     fmt::format("has not the {} fields of the head", table.head.size()));
    }
    const auto months = row.fields.find("interval_months");
    if (months != row.fields.end() && !std::ranges::all_of(months->second, is_digit)) {
      return refusal(path, row.line,
                     fmt::format("'{}' is not a whole number of months", months->second));
    }
    const std::string toml = toml_of(row);
    const auto sensor = parse_sensor_file(toml, path);
    if (!sensor) {
      // The line of the text that was made of the row means nothing to anybody.
      const std::string& message = sensor.error().message;
      const std::size_t key = message.find("key '");
      return refusal(path, row.line, key == std::string::npos ? message : message.substr(key));
    }
    if (!serials.insert(sensor->serial).second) {
      return refusal(path, row.line,
                     fmt::format("serial number '{}' is there twice", sensor->serial));
    }
    files.push_back(toml);
  }
  if (files.empty()) {
    return refusal(path, 1, "has no sensor");
  }
  return files;
}

} // namespace dyncal::inline views
