#include "services/views/figures/enlargement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace dyncal::inline views::figures {
namespace {

constexpr std::size_t min_frequencies = 3;
constexpr double tick_label_room = 50;

// The lower half of the logarithmic range of x.
std::optional<Panel> low_half(const Panel& panel) {
  Range range(Scale::logarithmic);
  for (const Series& series : panel.series) {
    for (const Point& point : series.points) {
      range.include(point.x);
    }
  }
  if (range.empty()) {
    return std::nullopt;
  }
  const double limit = std::sqrt(range.low() * range.high()) * (1 + 1e-9);
  Panel low = panel;
  low.x_label.clear();
  low.y_label.clear();
  low.x_tick_labels = true;
  low.font_size = 10;
  std::erase_if(low.series, [](const Series& series) { return !series.in_enlargement; });
  std::set<double> frequencies;
  for (Series& series : low.series) {
    std::erase_if(series.points, [&](const Point& point) { return point.x > limit; });
    series.radius *= 0.8;
    for (const Point& point : series.points) {
      frequencies.insert(point.x);
    }
  }
  if (frequencies.size() < min_frequencies) {
    return std::nullopt;
  }
  return low;
}

bool holds_a_point(const Box& place, const Panel& panel, const Axes& axes) {
  constexpr double margin = 8;
  return std::any_of(panel.series.begin(), panel.series.end(), [&](const Series& series) {
    return std::any_of(series.points.begin(), series.points.end(), [&](const Point& point) {
      const Pixel pixel = axes.pixel(point.x, point.y);
      return pixel.x > place.left - margin && pixel.x < place.right() + margin &&
             pixel.y > place.top - margin && pixel.y < place.bottom() + margin;
    });
  });
}

std::optional<Box> free_corner(const Panel& panel, const Box& area) {
  constexpr double margin = 8;
  const double width = 0.40 * area.width;
  const double height = 0.46 * area.height;
  const double low = area.bottom() - height - margin;
  const double far = area.right() - width - margin;
  const Axes axes = axes_of(panel, area);
  for (const Pixel corner : {Pixel{area.left + margin, low}, Pixel{far, area.top + margin},
                             Pixel{far, low}, Pixel{area.left + margin, area.top + margin}}) {
    const Box place{corner.x, corner.y, width, height};
    if (!holds_a_point(place, panel, axes)) {
      return place;
    }
  }
  return std::nullopt;
}

} // namespace

void draw_enlargement(Svg& svg, const Panel& panel, const Box& area) {
  const auto low = low_half(panel);
  if (!low || !has_data(panel)) {
    return;
  }
  const auto place = free_corner(panel, area);
  if (!place) {
    return;
  }
  svg.rectangle(*place, "#ffffff", {.colour = "#aaaaaa", .width = 0.8});
  draw(svg, *low,
       {place->left + tick_label_room, place->top + 10, place->width - tick_label_room - 10,
        place->height - 34});
}

} // namespace dyncal::inline views::figures
