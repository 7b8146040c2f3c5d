#include "services/views/figures/picture.hpp"

#include <algorithm>

#include "services/views/figures/enlargement.hpp"

namespace dyncal::inline views::figures {
namespace {

// Rooms of labels, and between panels.
constexpr double left = 92;
constexpr double right_margin = 24;
constexpr double between_rows = 20;
constexpr double x_labels = 56;
constexpr double text_size = 11;
constexpr double text_line_height = 15;

std::vector<std::string> lines_below(const Picture& picture) {
  std::vector<std::string> lines;
  for (const std::string& text : picture.below) {
    const std::vector<std::string> wrapped =
        wrap_text(text, text_size, picture.width - left - right_margin);
    lines.insert(lines.end(), wrapped.begin(), wrapped.end());
  }
  return lines;
}

double draw_title(Svg& svg, const Picture& picture) {
  std::vector<const Panel*> panels;
  for (const Panel& panel : picture.panels) {
    panels.push_back(&panel);
  }
  return draw_header(svg, picture.title.title, picture.title.subtitle, panels, left,
                     picture.width - right_margin);
}

// Row by row, from the height that the title ends at.
std::vector<Box> places_of(const Picture& picture, double top) {
  const auto columns = static_cast<double>(picture.columns);
  const double column_width = (picture.width - right_margin) / columns;
  std::vector<Box> places;
  for (std::size_t first = 0; first < picture.panels.size(); first += picture.columns) {
    const std::size_t end = std::min(first + picture.columns, picture.panels.size());
    bool labels = false;
    for (std::size_t i = first; i < end; ++i) {
      const auto column = static_cast<double>(i - first);
      places.push_back(
          {column * column_width + left, top, column_width - left, picture.panel_height});
      labels = labels || picture.panels[i].x_tick_labels;
    }
    top += picture.panel_height + (labels ? x_labels : between_rows);
  }
  return places;
}

} // namespace

std::string svg_of(const Picture& picture) {
  Svg unused(picture.width, 0);
  const double top = draw_title(unused, picture);
  const std::vector<Box> places = places_of(picture, top);
  const double panels_end = (places.empty() ? top : places.back().bottom()) + x_labels;
  const std::vector<std::string> below = lines_below(picture);

  Svg svg(picture.width, panels_end + (below.empty() ? 0 : 10) +
                             text_line_height * static_cast<double>(below.size()));
  draw_title(svg, picture);
  for (std::size_t i = 0; i < places.size(); ++i) {
    draw(svg, picture.panels[i], places[i]);
    if (picture.panels[i].enlarges_low_x) {
      draw_enlargement(svg, picture.panels[i], places[i]);
    }
  }
  for (std::size_t i = 0; i < below.size(); ++i) {
    svg.text({left, panels_end + text_line_height * (static_cast<double>(i) + 0.5)}, below[i],
             {.size = text_size, .colour = "#555555"});
  }
  return svg.finish();
}

} // namespace dyncal::inline views::figures
