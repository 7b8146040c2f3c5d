#include "services/report/figures/transfer_function.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "services/report/figures/panel.hpp"

namespace dyncal::services::figures {
namespace {

constexpr double width = 820;
constexpr double left = 92;
constexpr double right = width - 24;
constexpr double panel_height = 270;

using Quantity = Point (*)(const ValueOverFrequency&);

Point magnitude(const ValueOverFrequency& point) {
  return {point.frequency_hz, point.value.magnitude, point.value.u_magnitude};
}
Point phase(const ValueOverFrequency& point) {
  return {point.frequency_hz, point.value.phase_rad, point.value.u_phase_rad};
}

// The phase plus as many whole turns as bring it next to the mean of the same frequency.
ValueOverFrequency in_turn_of_mean(ValueOverFrequency point,
                                   const std::vector<ValueOverFrequency>& mean) {
  const auto same = std::find_if(mean.begin(), mean.end(), [&](const auto& m) {
    return std::abs(m.frequency_hz - point.frequency_hz) <= 1e-6 * m.frequency_hz;
  });
  if (same == mean.end()) {
    return point;
  }
  constexpr double turn = 2 * std::numbers::pi;
  point.value.phase_rad +=
      turn * std::round((same->value.phase_rad - point.value.phase_rad) / turn);
  return point;
}

std::vector<Series> repetition_series(const TransferFunctionData& data, Quantity quantity) {
  std::map<std::uint32_t, std::vector<Point>> by_repetition;
  for (const auto& [repetition, point] : data.repetitions) {
    auto drawn = quantity(in_turn_of_mean(point, data.mean));
    drawn.half_bar = 0;
    by_repetition[repetition].push_back(drawn);
  }
  std::vector<Series> series;
  for (auto& [repetition, points] : by_repetition) {
    const auto index = series.size();
    // Markers of different size, because repetitions of a good sensor lie on top of each other.
    series.push_back({.label = fmt::format("#{}", repetition),
                      .points = std::move(points),
                      .colour = series_colour(index),
                      .marker = series_marker(index),
                      .radius = 6.0 - 1.2 * static_cast<double>(index % 3)});
  }
  return series;
}

Series mean_series(const TransferFunctionData& data, Quantity quantity) {
  Series series{.label = "mean ± u", .colour = "#222222", .joined = true, .line_width = 1.1};
  for (const auto& point : data.mean) {
    series.points.push_back(quantity(point));
  }
  std::sort(series.points.begin(), series.points.end(),
            [](const auto& a, const auto& b) { return a.x < b.x; });
  return series;
}

// A ring around every mean that has a flag.
Series flagged_series(const TransferFunctionData& data, Quantity quantity) {
  Series series{
      .label = "flagged, see below", .colour = "#CC0000", .marker = Marker::circle, .radius = 9};
  for (const auto& point : data.mean) {
    if (!point.flags.empty()) {
      series.points.push_back(quantity(point));
      series.points.back().half_bar = 0;
    }
  }
  return series;
}

// The straight line of the phase, which the logarithmic axis bends.
Series group_delay_series(const TransferFunctionData& data, const analysis::GroupDelay& delay) {
  Range frequencies(Scale::logarithmic);
  for (const auto& point : data.mean) {
    frequencies.include(point.frequency_hz);
  }
  Series series{.label = fmt::format("group delay {:.4g} ms", 1e3 * delay.delay_s),
                .colour = "#999999",
                .joined = true,
                .dashes = "6 4"};
  constexpr int steps = 100;
  for (int i = 0; i <= steps && !frequencies.empty(); ++i) {
    const double frequency = frequencies.low() * std::pow(frequencies.high() / frequencies.low(),
                                                          static_cast<double>(i) / steps);
    series.points.push_back(
        {frequency, delay.intercept_rad - 2 * std::numbers::pi * frequency * delay.delay_s});
  }
  return series;
}

Panel quantity_panel(const TransferFunctionData& data, Quantity quantity) {
  Panel panel;
  panel.x_label = "frequency in Hz";
  panel.x_scale = Scale::logarithmic;
  panel.series = repetition_series(data, quantity);
  if (!data.mean.empty()) {
    panel.series.insert(panel.series.begin(), mean_series(data, quantity));
  }
  if (Series flagged = flagged_series(data, quantity); !flagged.points.empty()) {
    panel.series.push_back(std::move(flagged));
  }
  return panel;
}

// The lower half of the logarithmic frequency range, when that holds enough points to be worth a
// closer look.
std::optional<Panel> low_frequencies(const Panel& panel) {
  Range range(Scale::logarithmic);
  for (const auto& series : panel.series) {
    for (const auto& point : series.points) {
      range.include(point.x);
    }
  }
  if (range.empty()) {
    return std::nullopt;
  }
  const double limit = std::sqrt(range.low() * range.high()) * (1 + 1e-9);
  Panel detail = panel;
  detail.x_label.clear();
  detail.y_label.clear();
  detail.font_size = 10;
  std::set<double> frequencies;
  for (auto& series : detail.series) {
    std::erase_if(series.points, [&](const auto& point) { return point.x > limit; });
    series.radius *= 0.8;
    for (const auto& point : series.points) {
      frequencies.insert(point.x);
    }
  }
  if (frequencies.size() < 3) {
    return std::nullopt;
  }
  return detail;
}

// A place inside the panel that hides no point: the inset with the room that its labels take, or
// nothing.
std::optional<Box> free_corner(const Panel& panel, const Box& area) {
  const double inset_width = 0.40 * area.width;
  const double inset_height = 0.46 * area.height;
  const double margin = 8;
  const double low = area.bottom() - inset_height - margin;
  const double far = area.right() - inset_width - margin;
  const auto axes = axes_of(panel, area);
  for (const Pixel corner : {Pixel{area.left + margin, low}, Pixel{far, area.top + margin},
                             Pixel{far, low}, Pixel{area.left + margin, area.top + margin}}) {
    const bool hides =
        std::any_of(panel.series.begin(), panel.series.end(), [&](const auto& series) {
          return std::any_of(series.points.begin(), series.points.end(), [&](const auto& point) {
            const auto pixel = axes.pixel(point.x, point.y);
            return pixel.x > corner.x - 8 && pixel.x < corner.x + inset_width + 8 &&
                   pixel.y > corner.y - 8 && pixel.y < corner.y + inset_height + 8;
          });
        });
    if (!hides) {
      return Box{corner.x, corner.y, inset_width, inset_height};
    }
  }
  return std::nullopt;
}

void draw_with_detail(Svg& svg, const Panel& panel, const Panel& detail_source, const Box& area) {
  draw(svg, panel, area);
  const auto detail = low_frequencies(detail_source);
  if (!detail || !has_data(panel)) {
    return;
  }
  const auto place = free_corner(panel, area);
  if (!place) {
    return;
  }
  svg.rectangle(*place, "#ffffff", {.colour = "#aaaaaa", .width = 0.8});
  const double labels = 50;
  draw(svg, *detail,
       {place->left + labels, place->top + 10, place->width - labels - 10, place->height - 34});
}

constexpr double legend_size = 11;
constexpr double legend_line_height = 15;

std::vector<std::string> legend_lines(const std::vector<std::string>& legend) {
  std::vector<std::string> lines;
  for (const std::string& text : legend) {
    const std::vector<std::string> wrapped = wrap_text(text, legend_size, right - left);
    lines.insert(lines.end(), wrapped.begin(), wrapped.end());
  }
  return lines;
}

std::string csv_of(const TransferFunctionData& data) {
  const auto unit = data.unit.empty() ? std::string("a unit that is not known") : data.unit;
  auto csv = csv_comment(data.title);
  csv += csv_comment(fmt::format("magnitude in {}; phase: lead, rad (ISO 2041), a delay has "
                                 "negative phase; u: standard uncertainty",
                                 unit));
  if (data.group_delay) {
    csv += csv_comment(fmt::format(
        "group delay {} s, u {} s, intercept {} rad", csv_number(data.group_delay->delay_s),
        csv_number(data.group_delay->u_delay_s), csv_number(data.group_delay->intercept_rad)));
  }
  if (!data.subtitle.empty()) {
    csv += csv_comment(data.subtitle);
  }
  csv += csv_comment("phase_rad of the means is continuous over frequency, of repetitions in (-pi, "
                     "pi]");
  for (const std::string& line : data.legend) {
    csv += csv_comment("flag " + line);
  }
  csv += "repetition,frequency_hz,magnitude,u_magnitude,phase_rad,u_phase_rad,flags\n";
  const auto add = [&](const std::string& repetition, const ValueOverFrequency& p) {
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{}\n", repetition,
                   csv_number(p.frequency_hz), csv_number(p.value.magnitude),
                   csv_number(p.value.u_magnitude), csv_number(p.value.phase_rad),
                   csv_number(p.value.u_phase_rad), p.flags);
  };
  for (const auto& [repetition, point] : data.repetitions) {
    add(std::to_string(repetition), point);
  }
  for (const auto& point : data.mean) {
    add("mean", point);
  }
  return csv;
}

} // namespace

Figure transfer_function_figure(const TransferFunctionData& data, const std::string& name) {
  auto magnitudes = quantity_panel(data, magnitude);
  magnitudes.y_label =
      data.unit.empty() || data.unit == "1" ? "magnitude" : "magnitude in " + data.unit;
  magnitudes.x_tick_labels = false;
  auto phases = quantity_panel(data, phase);
  phases.y_label = "phase (lead) in rad";
  auto magnitude_detail = magnitudes;
  magnitude_detail.x_tick_labels = true;
  const auto phase_detail = phases;
  if (data.group_delay) {
    phases.series.insert(phases.series.begin(), group_delay_series(data, *data.group_delay));
  }

  constexpr double header_room = 110;
  const std::vector<std::string> below = legend_lines(data.legend);
  const double panels_end = header_room + 2 * panel_height + 20 + 56;
  Svg svg(width, panels_end + (below.empty() ? 0 : 10) +
                     legend_line_height * static_cast<double>(below.size()));
  const double top =
      draw_header(svg, data.title, data.subtitle, {&magnitudes, &phases}, left, right);
  const double height = panel_height + (header_room - top) / 2;
  draw_with_detail(svg, magnitudes, magnitude_detail, {left, top, right - left, height});
  draw_with_detail(svg, phases, phase_detail, {left, top + height + 20, right - left, height});
  for (std::size_t i = 0; i < below.size(); ++i) {
    svg.text({left, panels_end + legend_line_height * (static_cast<double>(i) + 0.5)}, below[i],
             {.size = legend_size, .colour = "#555555"});
  }
  return {name, svg.finish(), csv_of(data)};
}

} // namespace dyncal::services::figures
