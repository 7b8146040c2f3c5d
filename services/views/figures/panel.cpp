#include "services/views/figures/panel.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "services/views/language/figure_sentences.hpp"

namespace dyncal::inline views::figures {
namespace {

const Stroke frame_stroke{.colour = "#444444", .width = 1};
const Stroke grid_stroke{.colour = "#dddddd", .width = 1};
const Stroke minor_grid_stroke{.colour = "#f0f0f0", .width = 1};

Range x_range(const Panel& panel) {
  Range range(panel.x_scale);
  for (const auto& point : panel.band) {
    range.include(point.x);
  }
  for (const auto& point : panel.dots) {
    range.include(point.x);
  }
  for (const auto& bar : panel.bars) {
    range.include(bar.left);
    range.include(bar.right);
  }
  for (const auto& series : panel.series) {
    for (const auto& point : series.points) {
      range.include(point.x);
    }
  }
  return range;
}

Range y_range(const Panel& panel) {
  Range range(panel.y_scale);
  for (const auto& point : panel.band) {
    range.include(point.low);
    range.include(point.high);
  }
  for (const auto& point : panel.dots) {
    range.include(point.y);
  }
  for (const auto& bar : panel.bars) {
    range.include(bar.height);
  }
  for (const auto& series : panel.series) {
    for (const auto& point : series.points) {
      range.include(point.y - point.half_bar);
      range.include(point.y + point.half_bar);
    }
  }
  return range;
}

Axis x_axis(const Panel& panel, const Range& range, double width) {
  if (panel.x_ticks.empty()) {
    return make_axis(range, std::max(2, static_cast<int>(width / (5.5 * panel.font_size))));
  }
  return make_axis(range, panel.x_ticks, text_width("0", panel.font_size) / width);
}

Axis in_language(Axis axis, Language language) {
  for (Tick& tick : axis.ticks) {
    tick.label = decimal(language, std::move(tick.label));
  }
  return axis;
}

double max_label(const Axis& axis, double font_size) {
  double longest = 0;
  for (const auto& tick : axis.ticks) {
    longest = std::max(longest, text_width(tick.label, font_size));
  }
  return longest;
}

std::string labelled(const std::string& label, const Axis& axis) {
  if (axis.factor.empty()) {
    return label;
  }
  return label.empty() ? axis.factor : label + "  (" + axis.factor + ")";
}

void draw_grid(Svg& svg, const Axes& axes) {
  for (const bool minor : {true, false}) {
    const auto& stroke = minor ? minor_grid_stroke : grid_stroke;
    for (const auto& tick : axes.x.ticks) {
      if (tick.label.empty() != minor) {
        continue;
      }
      const double x = axes.pixel(tick.value, axes.y.low).x;
      svg.line({x, axes.area.top}, {x, axes.area.bottom()}, stroke);
    }
    for (const auto& tick : axes.y.ticks) {
      if (tick.label.empty() != minor) {
        continue;
      }
      const double y = axes.pixel(axes.x.low, tick.value).y;
      svg.line({axes.area.left, y}, {axes.area.right(), y}, stroke);
    }
  }
}

void draw_scales(Svg& svg, const Panel& panel, const Axes& axes) {
  const auto& area = axes.area;
  const double size = panel.font_size;
  for (const auto& tick : axes.x.ticks) {
    const double x = axes.pixel(tick.value, axes.y.low).x;
    svg.line({x, area.bottom()}, {x, area.bottom() + (tick.label.empty() ? 3 : 5)}, frame_stroke);
    if (panel.x_tick_labels) {
      svg.text({x, area.bottom() + 6 + size}, tick.label, {.size = size, .anchor = Anchor::middle});
    }
  }
  for (const auto& tick : axes.y.ticks) {
    const double y = axes.pixel(axes.x.low, tick.value).y;
    svg.line({area.left - (tick.label.empty() ? 3 : 5), y}, {area.left, y}, frame_stroke);
    svg.text({area.left - 8, y + 0.36 * size}, tick.label, {.size = size, .anchor = Anchor::end});
  }
  if (panel.x_tick_labels) {
    svg.text({area.left + area.width / 2, area.bottom() + 14 + 2.1 * size},
             labelled(panel.x_label, axes.x), {.size = size + 1, .anchor = Anchor::middle});
  }
  const auto label = labelled(panel.y_label, axes.y);
  const double beside_labels = area.left - 16 - max_label(axes.y, size);
  svg.text({beside_labels, area.top + area.height / 2}, label,
           {.size = size + 1, .anchor = Anchor::middle, .upwards = true});
}

void draw_band(Svg& svg, const Panel& panel, const Axes& axes) {
  std::vector<Pixel> outline;
  for (const auto& point : panel.band) {
    if (axes.x.can_show(point.x) && axes.y.can_show(point.high) && axes.y.can_show(point.low)) {
      outline.push_back(axes.pixel(point.x, point.high));
    }
  }
  for (auto point = panel.band.rbegin(); point != panel.band.rend(); ++point) {
    if (axes.x.can_show(point->x) && axes.y.can_show(point->high) && axes.y.can_show(point->low)) {
      outline.push_back(axes.pixel(point->x, point->low));
    }
  }
  if (outline.empty()) {
    return;
  }
  svg.polygon(outline, panel.colour, 0.35);
  // The outline keeps a single narrow spike visible.
  outline.push_back(outline.front());
  svg.polyline(outline, {.colour = panel.colour, .width = 0.8});
}

void draw_bars(Svg& svg, const Panel& panel, const Axes& axes) {
  for (const auto& bar : panel.bars) {
    if (!axes.y.can_show(bar.height) || !axes.x.can_show(bar.left) || !axes.x.can_show(bar.right)) {
      continue;
    }
    const auto top = axes.pixel(bar.left, bar.height);
    const double width = axes.pixel(bar.right, bar.height).x - top.x;
    svg.rectangle({top.x, top.y, width, axes.area.bottom() - top.y}, panel.colour,
                  {.colour = "#ffffff", .width = width > 4 ? 0.7 : 0});
  }
}

std::vector<Pixel> shown_pixels(const std::vector<Point>& points, const Axes& axes) {
  std::vector<Pixel> result;
  for (const auto& point : points) {
    if (axes.x.can_show(point.x) && axes.y.can_show(point.y)) {
      result.push_back(axes.pixel(point.x, point.y));
    }
  }
  return result;
}

void draw_error_bar(Svg& svg, const Point& point, const Axes& axes, const std::string& colour,
                    bool crowded) {
  if (point.half_bar <= 0 || !axes.x.can_show(point.x) ||
      !axes.y.can_show(point.y - point.half_bar)) {
    return;
  }
  const auto low = axes.pixel(point.x, point.y - point.half_bar);
  const auto high = axes.pixel(point.x, point.y + point.half_bar);
  const Stroke stroke{.colour = colour, .width = 1, .opacity = crowded ? 0.5 : 1};
  svg.line(low, high, stroke);
  if (crowded) {
    return;
  }
  for (const auto& end : {low, high}) {
    svg.line({end.x - 3, end.y}, {end.x + 3, end.y}, stroke);
  }
}

void draw_series(Svg& svg, const Series& series, const Axes& axes) {
  const auto pixels = shown_pixels(series.points, axes);
  if (series.joined) {
    svg.polyline(pixels,
                 {.colour = series.colour, .width = series.line_width, .dashes = series.dashes});
  }
  const bool crowded = series.points.size() > 25;
  for (const auto& point : series.points) {
    draw_error_bar(svg, point, axes, series.colour, crowded);
  }
  for (const auto& pixel : pixels) {
    svg.marker(series.marker, pixel, series.radius, {.colour = series.colour, .width = 1.5});
  }
}

struct LegendEntry {
  std::string label;
  Series look;
  bool filled = false; // a band: a small coloured box
};

std::vector<LegendEntry> legend_of(const std::vector<const Panel*>& panels) {
  std::vector<LegendEntry> entries;
  const auto add = [&](LegendEntry entry) {
    const bool known = std::any_of(entries.begin(), entries.end(),
                                   [&](const auto& e) { return e.label == entry.label; });
    if (!entry.label.empty() && !known) {
      entries.push_back(std::move(entry));
    }
  };
  for (const auto* panel : panels) {
    if (!panel->band.empty()) {
      add({panel->band_label, {.colour = panel->colour}, true});
    }
    if (!panel->dots.empty()) {
      add({panel->dots_label, {.colour = panel->colour, .marker = Marker::dot, .radius = 1.6}});
    }
    for (const auto& series : panel->series) {
      add({series.label, series});
    }
  }
  return entries;
}

void draw_legend_sample(Svg& svg, const LegendEntry& entry, double x, double y) {
  if (entry.filled) {
    svg.rectangle({x, y - 5, 24, 10}, entry.look.colour, {.colour = entry.look.colour, .width = 0});
    return;
  }
  if (entry.look.joined) {
    svg.line(
        {x, y}, {x + 24, y},
        {.colour = entry.look.colour, .width = entry.look.line_width, .dashes = entry.look.dashes});
  }
  svg.marker(entry.look.marker, {x + 12, y}, entry.look.radius,
             {.colour = entry.look.colour, .width = 1.5});
}

// In rows below `above`. Returns the base line of the last one.
double draw_legend(Svg& svg, const std::vector<LegendEntry>& entries, const Pixel& above,
                   double right) {
  double x = above.x;
  double y = above.y + (entries.empty() ? 0 : 22);
  for (const auto& entry : entries) {
    const double entry_width = 30 + text_width(entry.label, 12) + 14;
    if (x > above.x && x + entry_width > right) {
      x = above.x;
      y += 18;
    }
    draw_legend_sample(svg, entry, x, y - 4);
    svg.text({x + 30, y}, entry.label, {.size = 12});
    x += entry_width;
  }
  return y;
}

} // namespace

Pixel Axes::pixel(double x_value, double y_value) const {
  return {area.left + x.position(x_value) * area.width,
          area.bottom() - y.position(y_value) * area.height};
}

Axes axes_of(const Panel& panel, const Box& area) {
  const double x_room =
      panel.fills_x && !x_range(panel).empty() && x_range(panel).high() > x_range(panel).low()
          ? 0.0
          : 0.04;
  const Range y = panel.y_range.value_or(y_range(panel).padded(0.07));
  const int y_ticks = std::max(3, static_cast<int>(area.height / (3 * panel.font_size)));
  return {in_language(x_axis(panel, x_range(panel).padded(x_room), area.width), panel.language),
          in_language(make_axis(y, y_ticks), panel.language), area};
}

bool has_data(const Panel& panel) {
  return !x_range(panel).empty() && !y_range(panel).empty();
}

void draw(Svg& svg, const Panel& panel, const Box& area) {
  const auto axes = axes_of(panel, area);
  svg.rectangle(area, "#fdfdfd", {.colour = "none", .width = 0});
  if (!has_data(panel)) {
    svg.text({area.left + area.width / 2, area.top + area.height / 2},
             std::string(sentences::no_data.in(panel.language)),
             {.size = panel.font_size + 4, .anchor = Anchor::middle, .colour = "#888888"});
    svg.rectangle(area, "none", frame_stroke);
    return;
  }
  draw_grid(svg, axes);
  svg.begin_clip(area);
  draw_band(svg, panel, axes);
  draw_bars(svg, panel, axes);
  svg.dots(shown_pixels(panel.dots, axes), 2.4,
           {.colour = panel.colour, .opacity = panel.dots.size() > 500 ? 0.5 : 0.8});
  for (const auto& series : panel.series) {
    draw_series(svg, series, axes);
  }
  svg.end_clip();
  svg.rectangle(area, "none", frame_stroke);
  draw_scales(svg, panel, axes);
}

double draw_header(Svg& svg, const std::string& title, const std::string& subtitle,
                   const std::vector<const Panel*>& panels, double left, double right) {
  const double width = right - left;
  const auto fitting = [&](const std::string& text, double size) {
    const double needed = text_width(text, size);
    return needed > width ? size * width / needed : size;
  };
  double y = 28;
  svg.text({left, y}, title, {.size = fitting(title, 16), .bold = true});
  if (!subtitle.empty()) {
    y += 20;
    svg.text({left, y}, subtitle, {.size = fitting(subtitle, 12), .colour = "#555555"});
  }
  return draw_legend(svg, legend_of(panels), {left, y}, right) + 12;
}

std::string series_colour(std::size_t index) {
  static constexpr std::array colours = {"#0072B2", "#D55E00", "#009E73",
                                         "#CC79A7", "#E69F00", "#56B4E9"};
  return colours[index % colours.size()];
}

Marker series_marker(std::size_t index) {
  static constexpr std::array markers = {Marker::circle, Marker::square, Marker::triangle,
                                         Marker::cross};
  return markers[index % markers.size()];
}

} // namespace dyncal::inline views::figures
