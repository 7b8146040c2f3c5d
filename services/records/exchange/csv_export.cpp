#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "services/base/csv_field.hpp"
#include "services/base/output_stream.hpp"
#include "services/records/exchange/row_formats.hpp"

namespace dyncal::inline records {
namespace {

std::string first_line(const RowTable& table) {
  std::string line;
  for (const RowColumn& column : table.columns()) {
    const bool has_unit = column.is_channel && !column.unit.empty();
    line += line.empty() ? "" : ",";
    line += csv_field(has_unit ? fmt::format("{} [{}]", column.name, column.unit) : column.name);
  }
  return line + "\n";
}

void append_number(std::string& text, double value) {
  if (std::isnan(value)) {
    text += "nan";
  } else {
    fmt::format_to(std::back_inserter(text), "{}", value); // the shortest with the same bits
  }
}
template <class Integer>
void append_number(std::string& text, Integer value) {
  fmt::format_to(std::back_inserter(text), "{}", value);
}

std::string lines_of(const Rows& rows) {
  std::string text;
  for (std::size_t row = 0; row < rows.count; ++row) {
    for (std::size_t column = 0; column < rows.columns.size(); ++column) {
      if (column > 0) {
        text += ',';
      }
      std::visit([&](const auto& values) { append_number(text, values[row]); },
                 rows.columns[column]);
    }
    text += '\n';
  }
  return text;
}

Expected<void> write_table(const RowTable& table, const std::filesystem::path& path,
                           RowProgress& progress) {
  DYNCAL_TRY(auto file, OutputStream::create(path));
  return file.write(first_line(table))
      .and_then([&] {
        return progress.for_each(table,
                                 [&](const Rows& rows) { return file.write(lines_of(rows)); });
      })
      .and_then([&] { return file.finish(); });
}

} // namespace

Expected<void> export_csv(const RowExport& wanted) {
  DYNCAL_TRY(auto folder, OutputFolder::create(wanted.to));
  RowProgress progress(wanted);
  for (const RowTable& table : wanted.tables) {
    const auto path = folder.unfinished_path() / (table.source().name + ".csv");
    DYNCAL_TRY(write_table(table, path, progress));
  }
  DYNCAL_TRY(auto contents, OutputStream::create(folder.unfinished_path() / "contents.json"));
  return contents.write(wanted.contents).and_then([&] { return contents.finish(); }).and_then([&] {
    return folder.finish();
  });
}

} // namespace dyncal::inline records
