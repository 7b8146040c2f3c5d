#include "services/views/figures/drift.hpp"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <utility>

#include <fmt/format.h>

namespace dyncal::inline views::figures {
namespace {

constexpr std::size_t max_lines = 6;

constexpr double percent = 100.0;
constexpr double degrees = 180.0 / std::numbers::pi;

using Quantity = Point (*)(const DriftValue&);

Point magnitude(const DriftValue& value) {
  const double first = value.magnitude / (1.0 + value.deviation_magnitude_rel);
  return {value.days, percent * value.deviation_magnitude_rel,
          percent * value.expanded_magnitude / first};
}

Point phase(const DriftValue& value) {
  return {value.days, degrees * value.deviation_phase_rad, degrees * value.expanded_phase_rad};
}

// First and last of the frequencies among them.
std::vector<const DriftLine*> shown_lines(const DriftData& data) {
  std::vector<const DriftLine*> shown;
  const std::size_t count = std::min(max_lines, data.lines.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t place = count == 1 ? 0 : i * (data.lines.size() - 1) / (count - 1);
    shown.push_back(&data.lines[place]);
  }
  return shown;
}

Panel quantity_panel(const DriftData& data, Quantity quantity, const std::string& y_label) {
  Panel panel;
  panel.x_label = "days since the first calibration";
  panel.y_label = y_label;
  for (const DriftLine* line : shown_lines(data)) {
    const std::size_t index = panel.series.size();
    Series series{.label = line->label,
                  .colour = series_colour(index),
                  .marker = series_marker(index),
                  .joined = true};
    std::transform(line->values.begin(), line->values.end(), std::back_inserter(series.points),
                   quantity);
    panel.series.push_back(std::move(series));
  }
  return panel;
}

std::string csv_of(const DriftData& data) {
  std::string csv = csv_comment(data.title);
  if (!data.subtitle.empty()) {
    csv += csv_comment(data.subtitle);
  }
  csv += csv_comment(fmt::format("magnitude in {}; phase: lead, rad; U: expanded uncertainty "
                                 "(95.45 %); deviations are from the first calibration",
                                 data.unit.empty() ? "a unit that is not known" : data.unit));
  csv += "frequency_hz,run,began_utc,days,magnitude,U_magnitude,deviation_magnitude_rel,"
         "phase_rad,U_phase_rad,deviation_phase_rad,level_m_s2,excited_axis\n";
  for (const DriftLine& line : data.lines) {
    for (const DriftValue& value : line.values) {
      fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{},{},{},{},{}\n",
                     csv_number(line.frequency_hz), value.run, value.began_utc,
                     csv_number(value.days), csv_number(value.magnitude),
                     csv_number(value.expanded_magnitude),
                     csv_number(value.deviation_magnitude_rel), csv_number(value.phase_rad),
                     csv_number(value.expanded_phase_rad), csv_number(value.deviation_phase_rad),
                     csv_number(line.level_m_s2), line.excited_axis);
    }
  }
  return csv;
}

} // namespace

Figure drift_figure(const DriftData& data, const std::string& name) {
  Picture picture{.title = {data.title, data.subtitle}};
  picture.panels = {quantity_panel(data, magnitude, "magnitude: deviation ± U in %"),
                    quantity_panel(data, phase, "phase: deviation ± U in degrees")};
  picture.panels.front().x_tick_labels = false;
  return {name, std::move(picture), csv_of(data)};
}

} // namespace dyncal::inline views::figures
