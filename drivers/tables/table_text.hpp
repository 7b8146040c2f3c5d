// What all formats of tables share: lines, cells of a line, columns by their names, numbers, and
// the sentence that says where a file is not what it should be.
//
// Lines end with LF or CRLF. Cells are without the blanks around them; what is no ASCII
// (ISO-8859-1, UTF-8) is kept as it is. Names are compared by their letters and digits alone, in
// any case: "Std.dev. S" and "stddev s". A failure (malformed) reads "FILE: line L, column C: WHAT;
// expected EXPECTED". Any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/error.hpp"

namespace dyncal::drivers::tables {

struct TableLine {
  std::size_t number = 0; // from 1
  std::string_view text;  // without its end
};

// All lines that have an end, and whether something without one follows the last of them.
struct TableLines {
  std::vector<TableLine> lines;
  bool cut = false;
};
[[nodiscard]] TableLines lines_of(std::string_view text);

[[nodiscard]] std::vector<std::string_view> cells_of(std::string_view line, char separator);
[[nodiscard]] std::string letters_of(std::string_view name);

// Where in the file something is. Column from 1; 0: the line as a whole.
struct TablePlace {
  const std::string& file;
  std::size_t line = 0;
  std::size_t column = 0;
};
[[nodiscard]] tl::unexpected<Error> refuse(const TablePlace& place, const std::string& what,
                                           const std::string& expected);

// Of a line with a number for every column that is asked for.
class TableColumns {
public:
  TableColumns(const std::string& file, std::size_t line, std::vector<std::string_view> names,
               char decimal_point);

  // Fails with the columns there are.
  [[nodiscard]] Expected<std::size_t> find(std::string_view name) const;
  [[nodiscard]] std::optional<std::size_t> find_if_there(std::string_view name) const;
  [[nodiscard]] std::size_t size() const { return names_.size(); }

  // Finite. `row` has a cell for every column.
  [[nodiscard]] Expected<double> number(std::size_t line, const std::vector<std::string_view>& row,
                                        std::size_t column) const;
  [[nodiscard]] TablePlace place(std::size_t line, std::size_t column) const {
    return {file_, line, column + 1};
  }

private:
  std::string file_;
  std::size_t line_;
  std::vector<std::string> names_;
  char decimal_point_;
};

[[nodiscard]] bool is_empty_or_comment(std::string_view line);

[[nodiscard]] Expected<void> require_above_0(const TablePlace& place, double value);
// m/s^2 in any spelling, without "rms"; degrees; Hz.
[[nodiscard]] Expected<void> require_acceleration(const TablePlace& place, std::string_view unit);
[[nodiscard]] Expected<void> require_degrees(const TablePlace& place, std::string_view unit);
[[nodiscard]] Expected<void> require_hertz(const TablePlace& place, std::string_view unit);

} // namespace dyncal::drivers::tables
