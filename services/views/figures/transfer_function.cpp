#include "services/views/figures/transfer_function.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "services/base/per_enumerator.hpp"
#include "services/base/rounding.hpp"
#include "services/views/language/figure_sentences.hpp"

namespace dyncal::inline views::figures {
namespace {

constexpr double panel_height = 270;

// With its error bar.
using Quantity = Point (*)(const ValueOverFrequency&, ErrorBars);

Point magnitude(const ValueOverFrequency& point, ErrorBars bars) {
  return {point.frequency_hz, point.value.magnitude, half_magnitude_bar(point, bars)};
}
Point phase(const ValueOverFrequency& point, ErrorBars bars) {
  return {point.frequency_hz, point.value.phase_rad, half_phase_bar(point, bars)};
}

// The phase plus as many whole turns as bring it next to the mean of the same frequency.
ValueOverFrequency in_turn_of_mean(ValueOverFrequency point, const TransferFunctionData& data) {
  const ValueOverFrequency* mean = mean_of(point, data);
  if (mean == nullptr) {
    return point;
  }
  constexpr double turn = 2 * std::numbers::pi;
  point.value.phase_rad +=
      turn * std::round((mean->value.phase_rad - point.value.phase_rad) / turn);
  return point;
}

std::vector<Series> repetition_series(const TransferFunctionData& data, Quantity quantity) {
  const ErrorBars bars = data.means_are_plain ? data.error_bars : ErrorBars::none;
  std::vector<std::optional<Point>> points;
  for (const RepetitionPoint& one : data.repetitions) {
    points.emplace_back(quantity(in_turn_of_mean(one.point, data), bars))->step = one.step;
  }
  std::vector<Series> series;
  for (MarkerGroup& group : marker_groups(data, points, bars)) {
    // Markers of different size, because repetitions of a good sensor lie on top of each other.
    series.push_back({.label = std::move(group.label),
                      .points = std::move(group.points),
                      .colour = series_colour(group.colour),
                      .marker = series_marker(group.colour),
                      .radius = 6.0 - 1.2 * static_cast<double>(group.colour % 3)});
  }
  return series;
}

std::string mean_label(const TransferFunctionData& data) {
  if (data.means_are_plain) {
    return sentences::mean_so_far_label(data.language);
  }
  return data.error_bars == ErrorBars::none
             ? sentences::mean_label(data.language)
             : sentences::mean_with_bar_label(data.language, symbol_of(data.error_bars));
}

// Of one level; nothing: of all.
Series mean_series(const TransferFunctionData& data, Quantity quantity,
                   std::optional<double> level_m_s2) {
  const ErrorBars bars = data.means_are_plain ? ErrorBars::none : data.error_bars;
  Series series{.label = mean_label(data), .colour = "#222222", .joined = true, .line_width = 1.1};
  for (const auto& point : data.mean) {
    if (!level_m_s2 || point.level_m_s2 == *level_m_s2) {
      series.points.push_back(quantity(point, bars));
    }
  }
  std::sort(series.points.begin(), series.points.end(),
            [](const auto& a, const auto& b) { return a.x < b.x; });
  return series;
}

std::string level_text(double level_m_s2) {
  return fmt::format("{:g} m/s²", level_m_s2);
}

std::vector<Series> mean_series(const TransferFunctionData& data, Quantity quantity) {
  if (data.mean.empty()) {
    return {};
  }
  const std::vector<double> levels = told_levels(data);
  if (levels.empty()) {
    return {mean_series(data, quantity, std::nullopt)};
  }
  std::vector<Series> all;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    Series& one = all.emplace_back(mean_series(data, quantity, levels[i]));
    one.label = fmt::format("{}: {}", level_text(levels[i]), one.label);
    one.colour = series_colour(i);
  }
  std::erase_if(all, [](const Series& one) { return one.points.empty(); });
  return all;
}

// A ring around every mean that has a flag.
Series flagged_series(const TransferFunctionData& data, Quantity quantity) {
  Series series{.label = sentences::flagged_label(data.language),
                .colour = "#CC0000",
                .marker = Marker::circle,
                .radius = 9};
  for (const auto& point : data.mean) {
    if (!point.flags.empty()) {
      series.points.push_back(quantity(point, ErrorBars::none));
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
  Series series{
      .label = sentences::delay_label(
          data.language, decimal(data.language, fmt::format("{:.4g}", 1e3 * delay.delay_s))),
      .colour = "#999999",
      .joined = true,
      .dashes = "6 4",
      .in_enlargement = false};
  constexpr int steps = 100;
  for (int i = 0; i <= steps && !frequencies.empty(); ++i) {
    const double frequency = frequencies.low() * std::pow(frequencies.high() / frequencies.low(),
                                                          static_cast<double>(i) / steps);
    series.points.push_back(
        {frequency, delay.intercept_rad - 2 * std::numbers::pi * frequency * delay.delay_s});
  }
  return series;
}

// With what the delay leaves of every phase, next to the intercept of the group delay.
TransferFunctionData without_delay(TransferFunctionData data) {
  const double delay_s = data.group_delay->delay_s;
  const double intercept_rad = data.group_delay->intercept_rad;
  const auto remove = [&](ValueOverFrequency& point) {
    constexpr double turn = 2 * std::numbers::pi;
    const double left_rad = point.value.phase_rad + turn * point.frequency_hz * delay_s;
    point.value.phase_rad = intercept_rad + std::remainder(left_rad - intercept_rad, turn);
  };
  std::for_each(data.mean.begin(), data.mean.end(), remove);
  for (RepetitionPoint& one : data.repetitions) {
    remove(one.point);
  }
  return data;
}

Panel quantity_panel(const TransferFunctionData& data, Quantity quantity) {
  Panel panel;
  panel.language = data.language;
  panel.x_label = sentences::frequency_axis.in(data.language);
  panel.x_scale = Scale::logarithmic;
  panel.x_ticks = measured_frequencies(data);
  panel.enlarges_low_x = true;
  panel.series = mean_series(data, quantity);
  std::vector<Series> repetitions = repetition_series(data, quantity);
  std::move(repetitions.begin(), repetitions.end(), std::back_inserter(panel.series));
  if (Series flagged = flagged_series(data, quantity); !flagged.points.empty()) {
    panel.series.push_back(std::move(flagged));
  }
  return panel;
}

std::string magnitude_label(const TransferFunctionData& data) {
  if (data.unit.empty()) {
    return sentences::magnitude_unknown_axis(data.language);
  }
  return data.unit == "1" ? sentences::magnitude_axis(data.language)
                          : sentences::magnitude_in_axis(data.language, data.unit);
}

Panel phase_panel(const TransferFunctionData& data) {
  if (data.group_delay && data.removes_delay) {
    Panel panel = quantity_panel(without_delay(data), phase);
    panel.y_label = sentences::rest_of_phase_axis.in(data.language);
    panel.enlarges_low_x = false;
    return panel;
  }
  Panel panel = quantity_panel(data, phase);
  panel.y_label = sentences::phase_axis.in(data.language);
  if (data.group_delay) {
    panel.series.insert(panel.series.begin(), group_delay_series(data, *data.group_delay));
  }
  return panel;
}

std::string csv_of(const TransferFunctionData& data) {
  const auto unit = data.unit.empty() ? std::string("a unit that is not known") : data.unit;
  auto csv = csv_comment(data.title);
  csv += csv_comment(fmt::format("magnitude in {}; phase: lead, rad (ISO 2041), a delay has "
                                 "negative phase; u: standard uncertainty; U: expanded, 95.45 %, "
                                 "of means",
                                 unit));
  if (data.group_delay) {
    csv += csv_comment(fmt::format(
        "group delay {} s, u {} s, intercept {} rad, U of the delay {} s, k {}, nu_eff {}",
        csv_number(data.group_delay->delay_s), csv_number(data.group_delay->of_delay.u),
        csv_number(data.group_delay->intercept_rad),
        csv_number(data.group_delay->of_delay.expanded()), csv_number(data.group_delay->of_delay.k),
        csv_number(data.group_delay->of_delay.degrees_of_freedom)));
  }
  if (!data.subtitle.empty()) {
    csv += csv_comment(data.subtitle);
  }
  csv += csv_comment("phase_rad of the means is continuous over frequency, of repetitions in (-pi, "
                     "pi]");
  for (const std::string& line : data.flag_sentences) {
    csv += csv_comment("flag " + line);
  }
  csv += csv_comment("_text: as page, report and certificate show it: of repetitions rounded by u, "
                     "of means by U and in (-pi, pi]");
  csv += "repetition,frequency_hz,magnitude,u_magnitude,phase_rad,u_phase_rad,flags,U_magnitude,"
         "U_phase_rad,magnitude_text,uncertainty_magnitude_text,phase_rad_text,"
         "uncertainty_phase_rad_text,level_m_s2,excited_axis,attempt\n";
  const auto add = [&](const std::string& repetition, const std::string& attempt,
                       const ValueOverFrequency& p) {
    const bool is_mean = repetition == "mean";
    const RoundedValue magnitude = round_by_uncertainty(
        p.value.magnitude, is_mean ? p.expanded_magnitude : p.value.u_magnitude);
    const RoundedValue phase = is_mean
                                   ? round_phase(p.stated_phase_rad, p.expanded_phase_rad).radians
                                   : round_phase(p.value.phase_rad, p.value.u_phase_rad).radians;
    fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                   repetition, csv_number(p.frequency_hz), csv_number(p.value.magnitude),
                   csv_number(p.value.u_magnitude), csv_number(p.value.phase_rad),
                   csv_number(p.value.u_phase_rad), p.flags,
                   is_mean ? csv_number(p.expanded_magnitude) : "",
                   is_mean ? csv_number(p.expanded_phase_rad) : "", magnitude.value, magnitude.u,
                   phase.value, phase.u, csv_number(p.level_m_s2), data.excited_axis, attempt);
  };
  for (const RepetitionPoint& one : data.repetitions) {
    add(std::to_string(one.repetition), std::to_string(one.attempt), one.point);
  }
  for (const auto& point : data.mean) {
    add("mean", "", point);
  }
  return csv;
}

} // namespace

const char* symbol_of(ErrorBars bars) {
  return per_enumerator(bars, {"u", "U", ""});
}

double half_magnitude_bar(const ValueOverFrequency& value, ErrorBars bars) {
  return per_enumerator(bars, {value.value.u_magnitude, value.expanded_magnitude, 0.0});
}

double half_phase_bar(const ValueOverFrequency& value, ErrorBars bars) {
  return per_enumerator(bars, {value.value.u_phase_rad, value.expanded_phase_rad, 0.0});
}

std::vector<double> told_levels(const TransferFunctionData& data) {
  std::set<double> levels;
  std::set<double> frequencies;
  std::set<std::pair<double, double>> excited;
  const auto add = [&](const ValueOverFrequency& one) {
    levels.insert(one.level_m_s2);
    frequencies.insert(one.frequency_hz);
    excited.emplace(one.frequency_hz, one.level_m_s2);
  };
  std::for_each(data.mean.begin(), data.mean.end(), add);
  for (const RepetitionPoint& one : data.repetitions) {
    add(one.point);
  }
  return excited.size() > frequencies.size() ? std::vector(levels.begin(), levels.end())
                                             : std::vector<double>{};
}

std::vector<double> measured_frequencies(const TransferFunctionData& data) {
  std::set<double> frequencies;
  for (const ValueOverFrequency& point : data.mean) {
    frequencies.insert(point.frequency_hz);
  }
  for (const RepetitionPoint& one : data.repetitions) {
    frequencies.insert(one.point.frequency_hz);
  }
  return {frequencies.begin(), frequencies.end()};
}

std::vector<MarkerGroup> marker_groups(const TransferFunctionData& data,
                                       const std::vector<std::optional<Point>>& points,
                                       ErrorBars bars) {
  const std::vector<double> levels = told_levels(data);
  std::map<double, MarkerGroup> by_place; // level, or repetition
  for (std::size_t i = 0; i < points.size(); ++i) {
    const RepetitionPoint& one = data.repetitions[i];
    if (points[i]) {
      by_place[levels.empty() ? one.repetition : one.point.level_m_s2].points.push_back(*points[i]);
    }
  }
  std::vector<MarkerGroup> groups;
  for (auto& [place, group] : by_place) {
    group.label = levels.empty() ? fmt::format("#{}", place) : level_text(place);
    group.label += bars == ErrorBars::none ? "" : fmt::format(" ± {}", symbol_of(bars));
    group.colour = levels.empty()
                       ? groups.size()
                       : static_cast<std::size_t>(std::find(levels.begin(), levels.end(), place) -
                                                  levels.begin());
    groups.push_back(std::move(group));
  }
  return groups;
}

const ValueOverFrequency* mean_of(const ValueOverFrequency& repetition,
                                  const TransferFunctionData& data) {
  const auto same = std::find_if(data.mean.begin(), data.mean.end(), [&](const auto& mean) {
    return mean.level_m_s2 == repetition.level_m_s2 &&
           std::abs(mean.frequency_hz - repetition.frequency_hz) <= 1e-6 * mean.frequency_hz;
  });
  return same == data.mean.end() ? nullptr : &*same;
}

Figure transfer_function_figure(const TransferFunctionData& data, const std::string& name) {
  Picture picture{.title = {data.title, data.subtitle},
                  .panels = {quantity_panel(data, magnitude), phase_panel(data)},
                  .below = data.flag_sentences,
                  .panel_height = panel_height};
  Panel& magnitudes = picture.panels.front();
  magnitudes.y_label = magnitude_label(data);
  magnitudes.x_tick_labels = false;
  return {name, std::move(picture), csv_of(data)};
}

} // namespace dyncal::inline views::figures
