// One pair of axes with what is drawn in it, and the lines of text above all panels of a figure.
//
// Points that an axis cannot show (not finite, not positive on a logarithmic axis) are left out; a
// panel without any point shows "no data".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/views/figures/axis.hpp"
#include "services/views/figures/svg.hpp"
#include "services/views/language/language.hpp"

namespace dyncal::inline views::figures {

struct Point {
  double x;
  double y;
  double half_bar = 0;    // of an error bar; 0: none
  std::uint32_t step = 0; // that it is the result of; 0: none
};

struct Series {
  std::string label{}; // empty: not in the legend
  std::vector<Point> points{};
  std::string colour = "#333333";
  Marker marker = Marker::none;
  double radius = 4;
  bool joined = false; // by a line
  std::string dashes{};
  double line_width = 1.4;
  bool in_enlargement = true;
};

struct Bar {
  double left;
  double right;
  double height;
};

struct BandPoint {
  double x;
  double low;
  double high;
};

struct Panel {
  std::string x_label{};
  std::string y_label{};
  Scale x_scale = Scale::linear;
  Scale y_scale = Scale::linear;
  // Drawn in this order.
  std::vector<BandPoint> band{};
  std::vector<Bar> bars{};
  std::vector<Point> dots{};
  std::vector<Series> series{};
  std::string colour = "#0072B2"; // of band, bars and dots
  std::string band_label{};       // in the legend; empty: not there
  std::string dots_label{};
  std::optional<Range> y_range{}; // in place of the range of the data
  // Where the x axis has ticks, rising, with labels as far as there is room; empty: round numbers.
  std::vector<double> x_ticks{};
  bool x_tick_labels = true;
  bool fills_x = false;        // the data reach from edge to edge
  bool enlarges_low_x = false; // in a free corner (enlargement.hpp)
  double font_size = 12;
  Language language = Language::english; // of its numbers
};

struct Axes {
  Axis x;
  Axis y;
  Box area;
  [[nodiscard]] Pixel pixel(double x_value, double y_value) const;
};

// The axes that `draw` will use in this area.
[[nodiscard]] Axes axes_of(const Panel& panel, const Box& area);
[[nodiscard]] bool has_data(const Panel& panel);
void draw(Svg& svg, const Panel& panel, const Box& area);

// Title, subtitle and the legend of all panels, from the top of the figure. Returns the height that
// they take.
double draw_header(Svg& svg, const std::string& title, const std::string& subtitle,
                   const std::vector<const Panel*>& panels, double left, double right);

// Colours that people with any colour vision tell apart (Okabe and Ito), and the markers that go
// round with them.
[[nodiscard]] std::string series_colour(std::size_t index);
[[nodiscard]] Marker series_marker(std::size_t index);

} // namespace dyncal::inline views::figures
