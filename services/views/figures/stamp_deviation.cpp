#include "services/views/figures/stamp_deviation.hpp"

#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>

namespace dyncal::inline views::figures {
namespace {

constexpr double panel_height = 210;
constexpr int wanted_bins = 60;

constexpr double hours_from_s = 2 * 3600.0; // a longer record has its time in hours

Panel time_panel(const StampDeviationData& data) {
  const bool hours = !data.deviations.empty() && data.deviations.back().time_s > hours_from_s;
  Panel panel;
  panel.x_label = hours ? "time in h" : "time in s";
  panel.y_label = "deviation in ns";
  panel.fills_x = true;
  for (const auto& point : data.deviations) {
    panel.dots.push_back({point.time_s / (hours ? 3600.0 : 1.0), 1e9 * point.deviation_s});
  }
  return panel;
}

double bin_width_s(const StampDeviationData& data) {
  Range range;
  for (const auto& point : data.deviations) {
    range.include(point.deviation_s);
  }
  const double plain_s = range.empty() || !(range.high() > range.low())
                             ? 1e-9
                             : (range.high() - range.low()) / wanted_bins;
  return data.tick_s > 0 ? data.tick_s * std::max(1.0, std::ceil(plain_s / data.tick_s)) : plain_s;
}

Panel histogram_panel(const StampDeviationData& data) {
  Panel panel;
  panel.x_label = "deviation in ns";
  panel.y_label = "count per bin";
  const double bin_s = bin_width_s(data);
  std::map<long long, double> bins;
  for (const auto& point : data.deviations) {
    bins[std::llround(point.deviation_s / bin_s)] += 1;
  }
  Range counts;
  counts.include(0);
  counts.include(1); // an empty histogram, too
  for (const auto& [bin, count] : bins) {
    const double centre_ns = 1e9 * bin_s * static_cast<double>(bin);
    panel.bars.push_back({centre_ns - 0.5e9 * bin_s, centre_ns + 0.5e9 * bin_s, count});
    counts.include(1.08 * count);
  }
  panel.y_range = counts;
  return panel;
}

Panel allan_panel(const StampDeviationData& data) {
  Panel panel;
  panel.x_label = "averaging time in s";
  panel.y_label = "Allan deviation (relative)";
  panel.x_scale = Scale::logarithmic;
  panel.y_scale = Scale::logarithmic;
  Series series{
      .colour = series_colour(1), .marker = Marker::circle, .radius = 3.5, .joined = true};
  for (const auto& point : data.allan) {
    series.points.push_back({point.tau_s, point.deviation});
  }
  panel.series.push_back(std::move(series));
  return panel;
}

std::string csv_of(const StampDeviationData& data) {
  auto csv = csv_comment(data.title);
  for (const auto& comment : data.comments) {
    csv += csv_comment(comment);
  }
  csv += "session,time_s,deviation_s\n";
  for (const auto& point : data.deviations) {
    fmt::format_to(std::back_inserter(csv), "{},{},{}\n", point.session + 1,
                   csv_number(point.time_s), csv_number(point.deviation_s));
  }
  return csv;
}

} // namespace

Figure stamp_deviation_figure(const StampDeviationData& data, const std::string& name) {
  Picture picture{.title = {data.title, data.subtitle}, .panel_height = panel_height};
  picture.panels = {time_panel(data), histogram_panel(data)};
  if (!data.allan.empty()) {
    picture.panels.push_back(allan_panel(data));
  }
  return {name, std::move(picture), csv_of(data)};
}

} // namespace dyncal::inline views::figures
