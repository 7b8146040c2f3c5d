// The means of a result as rows for spreadsheets: one for each channel, frequency and level.
// Numbers are those of the result file, with every digit; NaN: not known. Plain data; any thread.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct NumberCell {
  double value = 0.0;
  int decimals = -1; // to be shown; -1: all
};
using TableCell = std::variant<std::string, NumberCell>;

struct MeansTable {
  std::vector<std::string> head; // "U_magnitude", units in the names
  std::vector<std::vector<TableCell>> rows;
};

[[nodiscard]] MeansTable means_table(const StoredResult& result);

} // namespace dyncal::inline views
