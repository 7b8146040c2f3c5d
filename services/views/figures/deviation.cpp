#include "services/views/figures/deviation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "services/views/language/figure_sentences.hpp"

namespace dyncal::inline views::figures {
namespace {

constexpr double percent = 100.0;
constexpr double degrees = 180.0 / std::numbers::pi;

struct Deviation {
  const RepetitionPoint* of = nullptr;
  double frequency_hz = 0.0;
  double magnitude_rel = 0.0;
  double u_magnitude_rel = 0.0;
  double phase_rad = 0.0;
  double u_phase_rad = 0.0;
  double half_magnitude_bar_rel = 0.0;
  double half_phase_bar_rad = 0.0;
  double residual_rel = 0.0;
};

// Of the repetitions.
ErrorBars bars_of(const TransferFunctionData& data) {
  const bool have_band = !data.means_are_plain && data.error_bars != ErrorBars::none;
  return have_band ? ErrorBars::standard : data.error_bars;
}

// In the order of the repetitions; nothing for one without a mean. They live as long as the data.
std::vector<std::optional<Deviation>> deviations_of(const TransferFunctionData& data) {
  const ErrorBars bars = bars_of(data);
  std::vector<std::optional<Deviation>> deviations;
  for (const RepetitionPoint& one : data.repetitions) {
    const ValueOverFrequency& point = one.point;
    const ValueOverFrequency* mean = mean_of(point, data);
    auto& deviation = deviations.emplace_back();
    if (mean == nullptr) {
      continue;
    }
    const double magnitude = mean->value.magnitude;
    deviation = {
        &one,
        point.frequency_hz,
        point.value.magnitude / magnitude - 1.0,
        point.value.u_magnitude / magnitude,
        std::remainder(point.value.phase_rad - mean->value.phase_rad, 2 * std::numbers::pi),
        point.value.u_phase_rad,
        half_magnitude_bar(point, bars) / magnitude,
        half_phase_bar(point, bars),
        one.residual_rel};
  }
  return deviations;
}

using Quantity = Point (*)(const Deviation&);

Point magnitude(const Deviation& deviation) {
  return {deviation.frequency_hz, percent * deviation.magnitude_rel,
          percent * deviation.half_magnitude_bar_rel, deviation.of->step};
}
Point phase(const Deviation& deviation) {
  return {deviation.frequency_hz, degrees * deviation.phase_rad,
          degrees * deviation.half_phase_bar_rad, deviation.of->step};
}
Point residual(const Deviation& deviation) {
  return {deviation.frequency_hz, percent * deviation.residual_rel, 0.0, deviation.of->step};
}

Panel panel_of(const TransferFunctionData& data,
               const std::vector<std::optional<Deviation>>& deviations, ErrorBars bars,
               Quantity quantity, std::string y_label) {
  std::vector<std::optional<Point>> points;
  for (const auto& deviation : deviations) {
    points.push_back(deviation ? std::optional(quantity(*deviation)) : std::nullopt);
  }
  Panel panel;
  panel.language = data.language;
  panel.x_label = sentences::frequency_axis.in(data.language);
  panel.y_label = std::move(y_label);
  panel.x_scale = Scale::logarithmic;
  panel.x_ticks = measured_frequencies(data);
  panel.x_tick_labels = false;
  panel.colour = "#cccccc";
  for (MarkerGroup& group : marker_groups(data, points, bars)) {
    panel.series.push_back({.label = std::move(group.label),
                            .points = std::move(group.points),
                            .colour = series_colour(group.colour),
                            .marker = series_marker(group.colour),
                            .radius = 3.5});
  }
  return panel;
}

// The mean itself: zero, with its bar on both sides.
void add_mean(Panel& panel, const TransferFunctionData& data,
              double (*half_width)(const ValueOverFrequency&, ErrorBars)) {
  if (data.means_are_plain || data.error_bars == ErrorBars::none) {
    return;
  }
  panel.band_label = sentences::band_of_mean_label(
      data.language, symbol_of(data.error_bars),
      told_levels(data).empty() ? "" : sentences::largest_of_levels.in(data.language));
  std::map<double, double> half_by_frequency;
  for (const ValueOverFrequency& mean : data.mean) {
    double& half = half_by_frequency[mean.frequency_hz];
    half = std::max(half, half_width(mean, data.error_bars));
  }
  for (const auto& [frequency_hz, half] : half_by_frequency) {
    panel.band.push_back({frequency_hz, -half, half});
  }
}

double magnitude_half_width(const ValueOverFrequency& mean, ErrorBars bars) {
  return percent * half_magnitude_bar(mean, bars) / mean.value.magnitude;
}
double phase_half_width(const ValueOverFrequency& mean, ErrorBars bars) {
  return degrees * half_phase_bar(mean, bars);
}

std::string csv_of(const TransferFunctionData& data,
                   const std::vector<std::optional<Deviation>>& deviations) {
  std::string csv = csv_comment(data.title);
  if (!data.subtitle.empty()) {
    csv += csv_comment(data.subtitle);
  }
  csv += csv_comment(
      "deviation of each repetition from the mean at its frequency and level; phase: lead; u: "
      "standard uncertainty of the repetition; residual: what the fitted sine "
      "leaves of the channel, over its amplitude");
  csv += "repetition,frequency_hz,deviation_magnitude_rel,u_magnitude_rel,deviation_phase_rad,"
         "u_phase_rad,residual_rel,flags,level_m_s2,excited_axis,attempt\n";
  for (const auto& one : deviations) {
    if (one) {
      fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{},{},{},{}\n",
                     one->of->repetition, csv_number(one->frequency_hz),
                     csv_number(one->magnitude_rel), csv_number(one->u_magnitude_rel),
                     csv_number(one->phase_rad), csv_number(one->u_phase_rad),
                     csv_number(one->residual_rel), one->of->point.flags,
                     csv_number(one->of->point.level_m_s2), data.excited_axis, one->of->attempt);
    }
  }
  return csv;
}

} // namespace

Figure deviation_figure(const TransferFunctionData& data, const std::string& name) {
  const auto deviations = deviations_of(data);
  const ErrorBars bars = bars_of(data);
  Picture picture{.title = {sentences::deviation_title(data.language, data.title), data.subtitle},
                  .panel_height = 190};
  picture.panels = {
      panel_of(data, deviations, bars, magnitude,
               sentences::magnitude_deviation_axis(data.language)),
      panel_of(data, deviations, bars, phase, sentences::phase_deviation_axis(data.language))};
  add_mean(picture.panels[0], data, magnitude_half_width);
  add_mean(picture.panels[1], data, phase_half_width);
  if (std::any_of(deviations.begin(), deviations.end(),
                  [](const auto& one) { return one && std::isfinite(one->residual_rel); })) {
    Panel residuals = panel_of(data, deviations, ErrorBars::none, residual,
                               sentences::residual_axis(data.language));
    for (Series& series : residuals.series) {
      series.label.clear(); // those of the other panels, without the bars
    }
    residuals.y_scale = Scale::logarithmic;
    picture.panels.push_back(std::move(residuals));
  }
  picture.panels.back().x_tick_labels = true;
  return {name, std::move(picture), csv_of(data, deviations)};
}

} // namespace dyncal::inline views::figures
