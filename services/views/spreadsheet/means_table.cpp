#include "services/views/spreadsheet/means_table.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/contract/unit.hpp"

namespace dyncal::inline views {
namespace {

// The mean of what the reference measured of the excitation.
double measured_level(const StoredResult& result, const StoredValue& value) {
  double sum = 0.0;
  int count = 0;
  for (const StoredPoint& point : result.points) {
    if (point.valid && point.channel == value.channel && point.frequency_hz == value.frequency_hz &&
        point.level_m_s2 == value.level_m_s2 && std::isfinite(point.measured_level_m_s2)) {
      sum += point.measured_level_m_s2;
      ++count;
    }
  }
  return count > 0 ? sum / count : StepResult::nan_value;
}

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
                               NumberCell{measured_level(result, value)},
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
