#include "services/views/figures/control_chart.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

namespace dyncal::inline views::figures {
namespace {

constexpr std::size_t max_traces = 6;

// First and last among them.
std::vector<const ControlTrace*> shown_traces(const std::vector<ControlTrace>& traces) {
  std::vector<const ControlTrace*> shown;
  const std::size_t count = std::min(max_traces, traces.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t place = count == 1 ? 0 : i * (traces.size() - 1) / (count - 1);
    shown.push_back(&traces[place]);
  }
  return shown;
}

Series limit_line(const std::string& label, double height, double last_day, bool is_action) {
  return {.label = label,
          .points = {{0.0, height}, {last_day, height}},
          .colour = is_action ? "#B22222" : "#B3541E",
          .joined = true,
          .dashes = is_action ? "" : "6 4",
          .line_width = 1.0};
}

Panel panel_of(const std::vector<ControlTrace>& traces, const std::string& y_label) {
  Panel panel;
  panel.x_label = "days since the first result";
  panel.y_label = y_label;
  double last_day = 0.0;
  double warning = 0.0;
  for (const ControlTrace* trace : shown_traces(traces)) {
    const std::size_t index = panel.series.size();
    Series series{.label = trace->label,
                  .colour = series_colour(index),
                  .marker = series_marker(index),
                  .joined = true};
    for (const ControlPoint& point : trace->points) {
      series.points.push_back({point.days, point.deviation / trace->action});
      last_day = std::max(last_day, point.days);
    }
    warning = trace->warning / trace->action;
    panel.series.push_back(std::move(series));
  }
  if (!panel.series.empty()) {
    for (const double sign : {1.0, -1.0}) {
      panel.series.push_back(limit_line(sign > 0.0 ? "action" : "", sign, last_day, true));
      panel.series.push_back(
          limit_line(sign > 0.0 ? "warning" : "", sign * warning, last_day, false));
    }
  }
  return panel;
}

std::string csv_of(const ControlData& data) {
  std::string csv = csv_comment(data.title) + csv_comment(data.subtitle) +
                    csv_comment("deviations from the mean of the first results; warning, action: "
                                "half widths of the limits, in the same unit");
  csv += "line,quantity,run,began_utc,days,deviation,warning,action,state\n";
  for (const auto* traces : {&data.magnitudes, &data.phases}) {
    for (const ControlTrace& trace : *traces) {
      for (const ControlPoint& point : trace.points) {
        fmt::format_to(std::back_inserter(csv), "\"{}\",{},{},{},{},{},{},{},{}\n", trace.label,
                       trace.quantity, point.run, point.began_utc, csv_number(point.days),
                       csv_number(point.deviation), csv_number(trace.warning),
                       csv_number(trace.action), point.state);
      }
    }
  }
  return csv;
}

} // namespace

Figure control_figure(const ControlData& data, const std::string& name) {
  Picture picture{.title = {data.title, data.subtitle}};
  picture.panels = {panel_of(data.magnitudes, "|H|: deviation / action limit"),
                    panel_of(data.phases, "arg H: deviation / action limit")};
  picture.panels.front().x_tick_labels = false;
  return {name, std::move(picture), csv_of(data)};
}

} // namespace dyncal::inline views::figures
