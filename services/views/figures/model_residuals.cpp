#include "services/views/figures/model_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include <fmt/format.h>

namespace dyncal::inline views::figures {
namespace {

constexpr double percent = 100.0;
constexpr double degrees = 180.0 / std::numbers::pi;

struct Quantity { // one of the two that a residual has, in the unit of its picture
  double residual = 0.0;
  double u = 0.0;
  double own_u = 0.0;
  double in_own_u = 0.0;
};

Quantity magnitude(const ModelResidual& one) {
  return {percent * one.magnitude_rel, percent * one.u_magnitude_rel,
          percent * one.u_own_magnitude_rel, one.own_magnitude_rel / one.u_own_magnitude_rel};
}

Quantity phase(const ModelResidual& one) {
  return {degrees * one.phase_rad, degrees * one.u_phase_rad, degrees * one.u_own_phase_rad,
          one.own_phase_rad / one.u_own_phase_rad};
}

using QuantityOf = Quantity (*)(const ModelResidual&);

Panel plain_panel(const std::string& y_label, bool lowest) {
  Panel panel;
  panel.x_label = "frequency in Hz";
  panel.y_label = y_label;
  panel.x_scale = Scale::logarithmic;
  panel.x_tick_labels = lowest;
  return panel;
}

Series level(const ModelResidualData& data, double y, const std::string& label) {
  Series line{.label = label, .colour = "#777777", .joined = true, .line_width = 1.0};
  if (y != 0.0) {
    line.dashes = "6 4";
  }
  for (const ModelResidual& one : data.residuals) {
    line.points.push_back({one.frequency_hz, y});
  }
  return line;
}

Panel in_unit(const ModelResidualData& data, QuantityOf quantity, const std::string& y_label,
              bool lowest) {
  Panel panel = plain_panel(y_label, lowest);
  panel.band_label = "± u with what all values have in common";
  Series series{.label = "measured - model, ± own u",
                .colour = series_colour(0),
                .marker = Marker::circle,
                .radius = 3.5};
  for (const ModelResidual& one : data.residuals) {
    const Quantity value = quantity(one);
    panel.band.push_back({one.frequency_hz, -value.u, value.u});
    series.points.push_back({one.frequency_hz, value.residual, value.own_u});
  }
  panel.colour = "#bbbbbb";
  panel.series = {level(data, 0.0, ""), std::move(series)};
  return panel;
}

Panel in_u(const ModelResidualData& data, QuantityOf quantity, const std::string& y_label,
           bool lowest) {
  Panel panel = plain_panel(y_label, lowest);
  Series series{.label = "in own u, without what is common",
                .colour = series_colour(1),
                .marker = Marker::square,
                .radius = 3.5};
  double largest = 3.0;
  for (const ModelResidual& one : data.residuals) {
    series.points.push_back({one.frequency_hz, quantity(one).in_own_u});
    largest = std::max(largest, 1.1 * std::abs(quantity(one).in_own_u));
  }
  panel.series = {level(data, 0.0, ""), level(data, 2.0, "± 2 u"), level(data, -2.0, ""),
                  std::move(series)};
  Range range;
  range.include(-largest);
  range.include(largest);
  panel.y_range = range;
  return panel;
}

std::string csv_of(const ModelResidualData& data) {
  std::string csv = csv_comment(data.title);
  if (!data.subtitle.empty()) {
    csv += csv_comment(data.subtitle);
  }
  csv += csv_comment("residuals are measured - model; own: without the most probable errors that "
                     "all values have in common; u: standard uncertainty");
  for (const std::string& comment : data.comments) {
    csv += csv_comment(comment);
  }
  csv += "frequency_hz,magnitude_rel,u_magnitude_rel,u_own_magnitude_rel,own_magnitude_rel,"
         "phase_rad,u_phase_rad,u_own_phase_rad,own_phase_rad\n";
  for (const ModelResidual& one : data.residuals) {
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{},{}\n",
                   csv_number(one.frequency_hz), csv_number(one.magnitude_rel),
                   csv_number(one.u_magnitude_rel), csv_number(one.u_own_magnitude_rel),
                   csv_number(one.own_magnitude_rel), csv_number(one.phase_rad),
                   csv_number(one.u_phase_rad), csv_number(one.u_own_phase_rad),
                   csv_number(one.own_phase_rad));
  }
  return csv;
}

} // namespace

Figure model_residual_figure(const ModelResidualData& data, const std::string& name) {
  Picture picture{
      .title = {data.title, data.subtitle}, .columns = 2, .width = 980, .panel_height = 210};
  picture.panels = {in_unit(data, magnitude, "magnitude: residual in %", false),
                    in_u(data, magnitude, "residual in u", false),
                    in_unit(data, phase, "phase: residual in degrees", true),
                    in_u(data, phase, "residual in u", true)};
  return {name, std::move(picture), csv_of(data)};
}

} // namespace dyncal::inline views::figures
