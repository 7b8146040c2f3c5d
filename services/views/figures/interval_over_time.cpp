#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "services/views/figures/regular_intervals.hpp"
#include "services/views/figures/sample_clock.hpp"

namespace dyncal::inline views::figures {
namespace {

constexpr double panel_height = 230;

RegularIntervals regular_intervals(const analysis::SampleClockStatistics& clock) {
  std::vector<WeightedInterval> weighted;
  for (const auto& bucket : clock.over_time) {
    weighted.push_back({bucket.mean_ns, 1});
  }
  if (weighted.empty()) {
    for (const double interval_ns : clock.close_up_ns) {
      weighted.push_back({interval_ns, 1});
    }
  }
  return RegularIntervals(std::move(weighted));
}

Panel overview_panel(const analysis::SampleClockStatistics& clock,
                     const RegularIntervals& regular) {
  Panel panel;
  panel.x_label = "time in s";
  panel.y_label = "sample interval in µs";
  panel.band_label = "smallest to largest";
  panel.fills_x = true;
  Series means{.label = "mean", .colour = "#222222", .joined = true, .line_width = 1};
  Range intervals;
  for (const auto& bucket : clock.over_time) {
    panel.band.push_back({bucket.time_s, 1e-3 * bucket.minimum_ns, 1e-3 * bucket.maximum_ns});
    means.points.push_back({bucket.time_s, 1e-3 * bucket.mean_ns});
    for (const double interval_ns : {bucket.minimum_ns, bucket.mean_ns, bucket.maximum_ns}) {
      if (regular.contain(interval_ns)) {
        intervals.include(1e-3 * interval_ns);
      }
    }
  }
  panel.series.push_back(std::move(means));
  panel.y_range = intervals.padded(0.07);
  return panel;
}

Panel close_up_panel(const analysis::SampleClockStatistics& clock,
                     const RegularIntervals& regular) {
  Panel panel;
  panel.x_label = "time in s";
  panel.y_label = "sample interval in µs";
  Series series{.label = "close-up: every interval",
                .colour = series_colour(1),
                .marker = Marker::dot,
                .radius = 1.6,
                .joined = true};
  series.line_width = 0.9;
  Range intervals;
  double time_s = clock.close_up_first_time_s;
  for (const double interval_ns : clock.close_up_ns) {
    series.points.push_back({time_s, 1e-3 * interval_ns});
    if (regular.contain(interval_ns)) {
      intervals.include(1e-3 * interval_ns);
    }
    time_s += 1e-9 * interval_ns;
  }
  panel.series.push_back(std::move(series));
  panel.y_range = intervals.padded(0.07);
  return panel;
}

std::string csv_of(const PictureTitle& title, const analysis::SampleClockStatistics& clock) {
  auto csv =
      csv_comment(title.title) + csv_comment("kind: smallest, mean and largest interval of a "
                                             "stretch, or one interval of the close-up");
  csv += "kind,time_s,minimum_ns,mean_ns,maximum_ns\n";
  for (const auto& bucket : clock.over_time) {
    fmt::format_to(std::back_inserter(csv), "overview,{},{},{},{}\n", csv_number(bucket.time_s),
                   csv_number(bucket.minimum_ns), csv_number(bucket.mean_ns),
                   csv_number(bucket.maximum_ns));
  }
  double time_s = clock.close_up_first_time_s;
  for (const double interval_ns : clock.close_up_ns) {
    const auto interval = csv_number(interval_ns);
    fmt::format_to(std::back_inserter(csv), "close-up,{},{},{},{}\n", csv_number(time_s), interval,
                   interval, interval);
    time_s += 1e-9 * interval_ns;
  }
  return csv;
}

std::string subtitle_of(const PictureTitle& title, const analysis::SampleClockStatistics& clock,
                        const RegularIntervals& regular) {
  const auto outside = std::ranges::count_if(clock.over_time, [&](const auto& bucket) {
    return !regular.contain(bucket.minimum_ns) || !regular.contain(bucket.maximum_ns);
  });
  if (outside == 0) {
    return title.subtitle;
  }
  return fmt::format(
      "{}{}intervals beyond the axis (lost or doubled samples) in {} of {} stretches",
      title.subtitle, title.subtitle.empty() ? "" : "; ", outside, clock.over_time.size());
}

} // namespace

Figure interval_over_time_figure(const PictureTitle& title,
                                 const analysis::SampleClockStatistics& clock,
                                 const std::string& name) {
  const auto regular = regular_intervals(clock);
  Picture picture{.title = {title.title, subtitle_of(title, clock, regular)},
                  .panel_height = panel_height};
  picture.panels = {overview_panel(clock, regular), close_up_panel(clock, regular)};
  return {name, std::move(picture), csv_of(title, clock)};
}

} // namespace dyncal::inline views::figures
