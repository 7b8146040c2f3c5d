#include "services/views/figures/quadrature_ellipse.hpp"

#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include <fmt/format.h>

namespace dyncal::inline views::figures {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr int points_per_turn = 180;
constexpr double nm = 1e9;

struct Pair {
  double u1 = 0.0;
  double u2 = 0.0;
};

double phase_of(int point) {
  return two_pi * point / points_per_turn;
}

Pair raw_pair(const analysis::Ellipse& ellipse, double phase_rad) {
  return {ellipse.p + ellipse.radius * std::cos(phase_rad),
          ellipse.q + ellipse.radius / ellipse.r * std::sin(phase_rad - ellipse.alpha_rad)};
}

Pair corrected_pair(const analysis::Ellipse& ellipse, double phase_rad) {
  return {ellipse.radius * std::cos(phase_rad), ellipse.radius * std::sin(phase_rad)};
}

double error_nm(const QuadratureEllipseData& data, double error_rad) {
  return nm * std::abs(data.displacement_per_turn_m) * error_rad / two_pi;
}

double u_of_ellipse_nm(const QuadratureEllipseData& data) {
  double squares = 0.0;
  for (const double u_rad : data.u_ellipse_rad) {
    squares += u_rad * u_rad;
  }
  return error_nm(data, std::sqrt(squares));
}

Series curve(const QuadratureEllipseData& data, Pair (*pair)(const analysis::Ellipse&, double),
             std::string label, std::size_t colour) {
  Series series{.label = std::move(label),
                .colour = series_colour(colour),
                .joined = true,
                .line_width = 1.8};
  for (int i = 0; i <= points_per_turn; ++i) {
    const Pair at = pair(data.ellipse, phase_of(i));
    series.points.push_back({at.u1, at.u2});
  }
  return series;
}

Series centre(double u1, double u2, std::size_t colour) {
  return {.points = {{u1, u2}}, .colour = series_colour(colour), .marker = Marker::cross};
}

Panel ellipse_panel(const QuadratureEllipseData& data) {
  const analysis::Ellipse& ellipse = data.ellipse;
  Panel panel;
  panel.x_label = "u1, corrected X, in the unit of the signals";
  panel.y_label = "u2, Y";
  panel.series = {curve(data, raw_pair, "as recorded", 1), centre(ellipse.p, ellipse.q, 1),
                  curve(data, corrected_pair, "corrected", 0), centre(0.0, 0.0, 0)};
  return panel;
}

// At the middle of each part of the turn.
Series measured_radius(const QuadratureEllipseData& data) {
  Series series{.label = "radius, measured", .marker = Marker::dot, .radius = 2.2};
  const double parts = static_cast<double>(data.radius_deviation_rel.size());
  for (const double deviation_rel : data.radius_deviation_rel) {
    const double part = static_cast<double>(series.points.size()) + 0.5;
    series.points.push_back({360.0 * part / parts, error_nm(data, deviation_rel)});
  }
  return series;
}

Panel error_panel(const QuadratureEllipseData& data) {
  Panel panel;
  panel.x_label = "phase in degrees";
  panel.y_label = "error of the displacement in nm";
  panel.fills_x = true;
  panel.colour = "#bbbbbb";
  panel.x_ticks = {0, 45, 90, 135, 180, 225, 270, 315, 360};
  if (!data.u_ellipse_rad.empty()) {
    panel.band_label = "± u of the ellipse";
    const double u_nm = u_of_ellipse_nm(data);
    panel.band = {{0.0, -u_nm, u_nm}, {360.0, -u_nm, u_nm}};
  }
  for (std::size_t i = 0; i < data.periodic_error_rad.size(); ++i) {
    const double amplitude_nm = error_nm(data, data.periodic_error_rad[i]);
    Series series{.label = fmt::format("order {}: {:.2g} nm", i + 1, amplitude_nm),
                  .colour = series_colour(i + 2),
                  .joined = true};
    for (int point = 0; point <= points_per_turn; ++point) {
      const double phase_rad = phase_of(point);
      series.points.push_back({360.0 * point / points_per_turn,
                               amplitude_nm * std::sin(static_cast<double>(i + 1) * phase_rad)});
    }
    panel.series.push_back(std::move(series));
  }
  if (!data.radius_deviation_rel.empty()) {
    panel.series.push_back(measured_radius(data));
  }
  return panel;
}

// Of the part of the turn that this phase is in.
double measured_radius_m(const QuadratureEllipseData& data, int point) {
  const std::size_t parts = data.radius_deviation_rel.size();
  const std::size_t part = static_cast<std::size_t>(point) * parts / points_per_turn % parts;
  return error_nm(data, data.radius_deviation_rel[part]) / nm;
}

std::string csv_of(const QuadratureEllipseData& data) {
  const analysis::Ellipse& ellipse = data.ellipse;
  std::string csv = csv_comment(data.title.title);
  if (!data.title.subtitle.empty()) {
    csv += csv_comment(data.title.subtitle);
  }
  csv += csv_comment(fmt::format(
      "p {}, q {}, R {}, r {}, alpha {} rad; u of the ellipse {} m", csv_number(ellipse.p),
      csv_number(ellipse.q), csv_number(ellipse.radius), csv_number(ellipse.r),
      csv_number(ellipse.alpha_rad), csv_number(u_of_ellipse_nm(data) / nm)));
  csv += "phase_rad,u1,u2,x,y";
  for (std::size_t i = 0; i < data.periodic_error_rad.size(); ++i) {
    fmt::format_to(std::back_inserter(csv), ",error_order_{}_m", i + 1);
  }
  csv += data.radius_deviation_rel.empty() ? "\n" : ",measured_radius_deviation_m\n";
  for (int point = 0; point <= points_per_turn; ++point) {
    const double phase_rad = phase_of(point);
    const Pair raw = raw_pair(ellipse, phase_rad);
    const Pair corrected = corrected_pair(ellipse, phase_rad);
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{}", csv_number(phase_rad),
                   csv_number(raw.u1), csv_number(raw.u2), csv_number(corrected.u1),
                   csv_number(corrected.u2));
    for (std::size_t i = 0; i < data.periodic_error_rad.size(); ++i) {
      csv += ',' + csv_number(error_nm(data, data.periodic_error_rad[i]) / nm *
                              std::sin(static_cast<double>(i + 1) * phase_rad));
    }
    if (!data.radius_deviation_rel.empty()) {
      csv += ',' + csv_number(measured_radius_m(data, point));
    }
    csv += '\n';
  }
  return csv;
}

} // namespace

Figure quadrature_ellipse_figure(const QuadratureEllipseData& data, const std::string& name) {
  Picture picture{.title = data.title, .columns = 2, .width = 980, .panel_height = 374};
  picture.panels = {ellipse_panel(data), error_panel(data)};
  if (!data.below.empty()) {
    picture.below.push_back(data.below);
  }
  if (!data.periodic_error_rad.empty()) {
    picture.below.emplace_back("Each order is drawn from phase 0: how they lie to each other is "
                               "not known.");
  }
  if (!data.radius_deviation_rel.empty()) {
    picture.below.emplace_back("Dots: by how much the radius of the corrected signals differs from "
                               "its mean, measured, as the displacement of the same angle.");
  }
  return {name, std::move(picture), csv_of(data)};
}

} // namespace dyncal::inline views::figures
