#include "drivers/tables/spektra_table.hpp"

#include <algorithm>

#include <fmt/core.h>

namespace dyncal::drivers::tables {
namespace {

// What the two exports have in common.
struct SpektraForm {
  char separator;
  char decimal_point;
  const char* amplitude;
  const char* phase_deviation; // empty: none that could be used
  const char* absent;          // in place of a number
};
constexpr SpektraForm csv{';', '.', "Acceleration", "Std.Dev. Phase", ""};
constexpr SpektraForm prp{'\t', ',', "Accel.", "", "(Ref. value)"};

using Lines = std::vector<TableLine>;

Lines::const_iterator names_of(const SpektraForm& form, const Lines& lines) {
  const auto is_of_names = [&](const TableLine& line) {
    const auto cells = cells_of(line.text, form.separator);
    const auto has = [&](const char* name) {
      return std::ranges::any_of(
          cells, [&](std::string_view cell) { return letters_of(cell) == letters_of(name); });
    };
    return has("Frequency") && has(form.amplitude) && has("Phase");
  };
  const auto end =
      lines.begin() + static_cast<std::ptrdiff_t>(std::min(lines.size(), max_lines_of_head));
  const auto found = std::find_if(lines.begin(), end, is_of_names);
  return found == end ? lines.end() : found;
}

struct SpektraColumns {
  TableColumns all;
  const SpektraForm& form;
  std::size_t frequency, amplitude, phase;
  std::optional<std::size_t> phase_deviation, distortion_reference, distortion_sync;
};

Expected<SpektraColumns> columns_of(const SpektraForm& form, const std::string& file,
                                    const TableLine& names) {
  TableColumns all(file, names.number, cells_of(names.text, form.separator), form.decimal_point);
  DYNCAL_TRY(const auto frequency, all.find("Frequency"));
  DYNCAL_TRY(const auto amplitude, all.find(form.amplitude));
  DYNCAL_TRY(const auto phase, all.find("Phase"));
  const std::string_view deviation = form.phase_deviation;
  const auto phase_deviation = deviation.empty() ? std::nullopt : all.find_if_there(deviation);
  const auto distortion_reference = all.find_if_there("Distortion. Ref");
  const auto distortion_sync = all.find_if_there("Distortion. DUT");
  return SpektraColumns{
      std::move(all),       form,           frequency, amplitude, phase, phase_deviation,
      distortion_reference, distortion_sync};
}

Expected<void> check_units(const SpektraColumns& columns, const std::string& file,
                           const TableLine& units) {
  const auto cells = cells_of(units.text, columns.form.separator);
  if (cells.size() <= std::max({columns.frequency, columns.amplitude, columns.phase})) {
    return refuse({file, units.number}, "no units of all columns", "units: Hz, m/s2, ..., deg");
  }
  const auto place = [&](std::size_t column) { return columns.all.place(units.number, column); };
  DYNCAL_TRY(require_hertz(place(columns.frequency), cells[columns.frequency]));
  DYNCAL_TRY(require_acceleration(place(columns.amplitude), cells[columns.amplitude]));
  return require_degrees(place(columns.phase), cells[columns.phase]);
}

// Nothing where the column is not there, or its cell says that there is no value.
Expected<std::optional<double>> find_number(const SpektraColumns& columns, std::size_t line,
                                            const std::vector<std::string_view>& cells,
                                            const std::optional<std::size_t>& column) {
  if (!column || cells[*column].empty() || cells[*column] == columns.form.absent) {
    return std::nullopt;
  }
  DYNCAL_TRY(const double value, columns.all.number(line, cells, *column));
  if (value < 0.0) {
    return refuse(columns.all.place(line, *column), fmt::format("{}", value),
                  "a number of at least 0");
  }
  return value;
}

Expected<ReferenceTableRow> row_of(const SpektraColumns& columns, const std::string& file,
                                   const TableLine& line) {
  auto cells = cells_of(line.text, columns.form.separator);
  if (cells.size() > columns.all.size() && cells.back().empty()) {
    cells.pop_back(); // a separator at the end of the line
  }
  if (cells.size() != columns.all.size()) {
    return refuse({file, line.number}, fmt::format("{} cells", cells.size()),
                  fmt::format("{}, one for every name", columns.all.size()));
  }
  ReferenceTableRow row{.line = line.number, .loop = std::nullopt};
  DYNCAL_TRY(row.frequency_hz, columns.all.number(line.number, cells, columns.frequency));
  DYNCAL_TRY(row.amplitude_m_s2, columns.all.number(line.number, cells, columns.amplitude));
  DYNCAL_TRY(row.phase_deg, columns.all.number(line.number, cells, columns.phase));
  DYNCAL_TRY(row.phase_deviation_deg,
             find_number(columns, line.number, cells, columns.phase_deviation));
  DYNCAL_TRY(row.distortion_reference_rel,
             find_number(columns, line.number, cells, columns.distortion_reference));
  DYNCAL_TRY(row.distortion_sync_rel,
             find_number(columns, line.number, cells, columns.distortion_sync));
  for (std::optional<double>* percent : {&row.distortion_reference_rel, &row.distortion_sync_rel}) {
    *percent = *percent ? std::optional(**percent / 100.0) : std::nullopt;
  }
  DYNCAL_TRY(require_above_0(columns.all.place(line.number, columns.frequency), row.frequency_hz));
  DYNCAL_TRY(
      require_above_0(columns.all.place(line.number, columns.amplitude), row.amplitude_m_s2));
  return row;
}

Expected<std::vector<ReferenceTableRow>> read(const SpektraForm& form, const std::string& file,
                                              const Lines& lines) {
  const auto names = names_of(form, lines);
  if (names == lines.end() || names + 1 == lines.end()) {
    return refuse(
        {file, lines.size() + 1}, "the file ends",
        fmt::format("the names Frequency, {}, Phase, and behind them units", form.amplitude));
  }
  DYNCAL_TRY(const auto columns, columns_of(form, file, *names));
  DYNCAL_TRY(check_units(columns, file, *(names + 1)));
  std::vector<ReferenceTableRow> rows;
  for (auto line = names + 2; line != lines.end(); ++line) {
    if (!is_empty_or_comment(line->text)) {
      DYNCAL_TRY(rows.emplace_back(), row_of(columns, file, *line));
    }
  }
  return rows;
}

} // namespace

bool may_lack_spektra_head(const Lines& lines) {
  const auto names = std::min(names_of(csv, lines), names_of(prp, lines)); // of the other: end
  return names == lines.end() ? lines.size() < max_lines_of_head : names + 1 == lines.end();
}

bool is_spektra_csv(const Lines& lines) {
  return names_of(csv, lines) != lines.end();
}

bool is_spektra_prp(const Lines& lines) {
  return names_of(prp, lines) != lines.end();
}

Expected<std::vector<ReferenceTableRow>> read_spektra_csv(const std::string& file,
                                                          const Lines& lines) {
  return read(csv, file, lines);
}

Expected<std::vector<ReferenceTableRow>> read_spektra_prp(const std::string& file,
                                                          const Lines& lines) {
  return read(prp, file, lines);
}

} // namespace dyncal::drivers::tables
