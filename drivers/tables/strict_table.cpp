#include "drivers/tables/strict_table.hpp"

#include <cmath>

#include <fmt/core.h>

namespace dyncal::drivers::tables {
namespace {

constexpr char separator = ';';
constexpr double largest_loop = 1e9;

struct StrictColumns {
  TableColumns all;
  std::size_t loop, frequency, amplitude, amplitude_deviation, phase, phase_deviation;
};

Expected<StrictColumns> columns_of(const std::string& file, const TableLine& names) {
  TableColumns all(file, names.number, cells_of(names.text, separator), '.');
  DYNCAL_TRY(const auto loop, all.find("loop"));
  DYNCAL_TRY(const auto frequency, all.find("frequency"));
  DYNCAL_TRY(const auto amplitude, all.find("ex_amp"));
  DYNCAL_TRY(const auto amplitude_deviation, all.find("ex_amp_std"));
  DYNCAL_TRY(const auto phase, all.find("phase"));
  DYNCAL_TRY(const auto phase_deviation, all.find("phase_std"));
  return StrictColumns{std::move(all),      loop,  frequency,      amplitude,
                       amplitude_deviation, phase, phase_deviation};
}

Expected<void> check_units(const StrictColumns& columns, const std::string& file,
                           const TableLine& units) {
  const auto cells = cells_of(units.text, separator);
  if (!units.text.starts_with('#') || cells.size() != columns.all.size()) {
    return refuse({file, units.number}, "no units of all columns",
                  "#Number;Hz;m/s^2;m/s^2;deg;deg");
  }
  const auto place = [&](std::size_t column) { return columns.all.place(units.number, column); };
  DYNCAL_TRY(require_hertz(place(columns.frequency), cells[columns.frequency]));
  for (const std::size_t one : {columns.amplitude, columns.amplitude_deviation}) {
    DYNCAL_TRY(require_acceleration(place(one), cells[one]));
  }
  for (const std::size_t one : {columns.phase, columns.phase_deviation}) {
    DYNCAL_TRY(require_degrees(place(one), cells[one]));
  }
  return {};
}

Expected<ReferenceTableRow> row_of(const StrictColumns& columns, const std::string& file,
                                   const TableLine& line) {
  const auto cells = cells_of(line.text, separator);
  if (cells.size() != columns.all.size()) {
    return refuse({file, line.number}, fmt::format("{} cells", cells.size()),
                  fmt::format("{}, as line 1 has names", columns.all.size()));
  }
  const auto number = [&](std::size_t column) {
    return columns.all.number(line.number, cells, column);
  };
  DYNCAL_TRY(const auto loop, number(columns.loop));
  if (loop != std::floor(loop) || loop < 0.0 || loop > largest_loop) {
    return refuse(columns.all.place(line.number, columns.loop), fmt::format("{}", loop),
                  "a whole number for the loop");
  }
  ReferenceTableRow row{.line = line.number, .loop = static_cast<std::int64_t>(loop)};
  DYNCAL_TRY(row.frequency_hz, number(columns.frequency));
  DYNCAL_TRY(row.amplitude_m_s2, number(columns.amplitude));
  DYNCAL_TRY(row.phase_deg, number(columns.phase));
  DYNCAL_TRY(row.amplitude_deviation_m_s2, number(columns.amplitude_deviation));
  DYNCAL_TRY(row.phase_deviation_deg, number(columns.phase_deviation));
  DYNCAL_TRY(require_above_0(columns.all.place(line.number, columns.frequency), row.frequency_hz));
  DYNCAL_TRY(
      require_above_0(columns.all.place(line.number, columns.amplitude), row.amplitude_m_s2));
  for (const auto& [column, value] :
       {std::pair{columns.amplitude_deviation, *row.amplitude_deviation_m_s2},
        std::pair{columns.phase_deviation, *row.phase_deviation_deg}}) {
    if (value < 0.0) {
      return refuse(columns.all.place(line.number, column), fmt::format("{}", value),
                    "a standard deviation of at least 0");
    }
  }
  return row;
}

} // namespace

bool is_strict_table(const std::vector<TableLine>& lines) {
  return !lines.empty() && letters_of(lines.front().text).starts_with("loopfrequencyexamp");
}

Expected<std::vector<ReferenceTableRow>> read_strict_table(const std::string& file,
                                                           const std::vector<TableLine>& lines) {
  if (lines.size() < lines_of_strict_head) {
    return refuse({file, lines.size() + 1}, "the file ends", "names, a free line, and units");
  }
  DYNCAL_TRY(const auto columns, columns_of(file, lines.front()));
  DYNCAL_TRY(check_units(columns, file, lines[lines_of_strict_head - 1]));
  std::vector<ReferenceTableRow> rows;
  for (std::size_t i = lines_of_strict_head; i < lines.size(); ++i) {
    if (!is_empty_or_comment(lines[i].text)) {
      DYNCAL_TRY(rows.emplace_back(), row_of(columns, file, lines[i]));
    }
  }
  return rows;
}

} // namespace dyncal::drivers::tables
