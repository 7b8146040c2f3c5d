#include "services/views/spreadsheet/means_table.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/contract/unit.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

// So that U has two significant digits.
int decimals_of(double expanded) {
  constexpr int most = 15;
  if (!(expanded > 0.0) || !std::isfinite(expanded)) {
    return -1;
  }
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(expanded)));
  return decimals < 0 ? 0 : std::min(decimals, most);
}

void add_quantity(double value, const ExpandedUncertainty& uncertainty, double factor,
                  std::vector<TableCell>& row) {
  const double expanded = factor * uncertainty.expanded;
  const int decimals = decimals_of(expanded);
  row.emplace_back(NumberCell{factor * value, decimals});
  row.emplace_back(NumberCell{expanded, decimals});
}

} // namespace

MeansTable means_table(const StoredResult& result) {
  constexpr double degrees = 180.0 / M_PI;
  constexpr int of_k = 2;
  MeansTable table{.head = {"channel", "frequency_hz", "level_planned_m_s2", "level_measured_m_s2",
                            "excited_axis", "unit", "magnitude", "U_magnitude", "k_magnitude",
                            "phase_deg", "U_phase_deg", "phase_rad", "U_phase_rad", "k_phase",
                            "repetitions", "flags"},
                   .rows = {}};
  for (const StoredValue& value : result.values) {
    std::vector<TableCell> row{value.channel,
                               NumberCell{value.frequency_hz},
                               NumberCell{value.level_m_s2},
                               NumberCell{measured_level_m_s2(result, value)},
                               value.excited_axis,
                               short_form(value.unit)};
    add_quantity(value.magnitude, value.of_magnitude, 1.0, row);
    row.emplace_back(NumberCell{value.of_magnitude.k, of_k});
    add_quantity(value.phase_rad, value.of_phase, degrees, row);
    add_quantity(value.phase_rad, value.of_phase, 1.0, row);
    row.emplace_back(NumberCell{value.of_phase.k, of_k});
    row.emplace_back(NumberCell{static_cast<double>(value.repetitions), 0});
    row.emplace_back(fmt::format("{}", fmt::join(value.flag_names, " ")));
    table.rows.push_back(std::move(row));
  }
  return table;
}

} // namespace dyncal::inline views
