#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "services/views/figures/regular_intervals.hpp"
#include "services/views/figures/sample_clock.hpp"

namespace dyncal::inline views::figures {
namespace {

constexpr double panel_height = 360;

std::string csv_of(const PictureTitle& title, const analysis::SampleClockStatistics& clock) {
  auto csv =
      csv_comment(title.title) +
      csv_comment("kind: one interval, or mean and standard deviation of a bin of temperature");
  csv += "kind,temperature_degc,interval_ns,sd_interval_ns,count\n";
  for (std::size_t i = 0;
       i < std::min(clock.scatter_temperature_degc.size(), clock.scatter_interval_ns.size()); ++i) {
    fmt::format_to(std::back_inserter(csv), "interval,{},{},,1\n",
                   csv_number(clock.scatter_temperature_degc[i]),
                   csv_number(clock.scatter_interval_ns[i]));
  }
  for (const auto& bin : clock.over_temperature) {
    fmt::format_to(std::back_inserter(csv), "bin,{},{},{},{}\n", csv_number(bin.temperature_degc),
                   csv_number(bin.mean_interval_ns), csv_number(bin.sd_interval_ns), bin.count);
  }
  return csv;
}

} // namespace

Figure interval_over_temperature_figure(const PictureTitle& title,
                                        const analysis::SampleClockStatistics& clock,
                                        const std::string& name) {
  const auto singles =
      std::min(clock.scatter_temperature_degc.size(), clock.scatter_interval_ns.size());
  std::vector<WeightedInterval> weighted;
  for (std::size_t i = 0; i < singles; ++i) {
    weighted.push_back({clock.scatter_interval_ns[i], 1});
  }
  const RegularIntervals regular(std::move(weighted));

  Panel panel;
  panel.x_label = "temperature measured by the sensor in °C";
  panel.y_label = "sample interval in µs";
  panel.dots_label = "single intervals";
  std::size_t outside = 0;
  for (std::size_t i = 0; i < singles; ++i) {
    if (regular.contain(clock.scatter_interval_ns[i])) {
      panel.dots.push_back(
          {clock.scatter_temperature_degc[i], 1e-3 * clock.scatter_interval_ns[i]});
    } else {
      ++outside;
    }
  }
  Series means{.label = "mean and standard deviation",
               .colour = series_colour(1),
               .marker = Marker::circle,
               .radius = 3.5,
               .joined = true};
  for (const auto& bin : clock.over_temperature) {
    if (bin.count > 0) {
      means.points.push_back(
          {bin.temperature_degc, 1e-3 * bin.mean_interval_ns, 1e-3 * bin.sd_interval_ns});
    }
  }
  std::ranges::sort(means.points, [](const auto& a, const auto& b) { return a.x < b.x; });
  panel.series.push_back(std::move(means));

  auto subtitle = title.subtitle;
  if (outside > 0) {
    subtitle += fmt::format("{}{} beyond the axis (lost or doubled samples)",
                            subtitle.empty() ? "" : "; ", outside);
  }
  Picture picture{.title = {title.title, subtitle}, .panel_height = panel_height};
  picture.panels.push_back(std::move(panel));
  return {name, std::move(picture), csv_of(title, clock)};
}

} // namespace dyncal::inline views::figures
