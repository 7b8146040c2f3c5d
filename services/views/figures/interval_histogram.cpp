#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "services/views/figures/regular_intervals.hpp"
#include "services/views/figures/sample_clock.hpp"

namespace dyncal::inline views::figures {
namespace {

constexpr double panel_height = 330;
constexpr int max_bins = 90;

struct Histogram {
  std::vector<Bar> bars; // microseconds
  double bin_ns = 0;
  std::int64_t ticks_per_bin = 0; // 0: the tick is not known
  std::uint64_t total = 0;
  std::uint64_t outside = 0;
};

Histogram merge_bins(const analysis::SampleClockStatistics& clock) {
  Histogram histogram;
  std::vector<WeightedInterval> weighted;
  for (const auto& c : clock.histogram) {
    weighted.push_back({c.interval_ns, static_cast<double>(c.count)});
  }
  const RegularIntervals regular(std::move(weighted));

  std::vector<analysis::IntervalHistogramBin> regular_bins;
  for (const auto& c : clock.histogram) {
    histogram.total += c.count;
    if (regular.contain(c.interval_ns)) {
      if (c.count > 0) {
        regular_bins.push_back(c);
      }
    } else {
      histogram.outside += c.count;
    }
  }
  if (regular_bins.empty()) {
    return histogram;
  }
  std::sort(regular_bins.begin(), regular_bins.end(),
            [](const auto& a, const auto& b) { return a.interval_ns < b.interval_ns; });
  const auto& first = regular_bins.front();
  const double span_ns = regular_bins.back().interval_ns - first.interval_ns;
  const double tick_ns = 1e9 * clock.tick_s;
  if (tick_ns > 0) {
    const auto ticks = regular_bins.back().ticks - first.ticks + 1;
    histogram.ticks_per_bin = std::max<std::int64_t>(1, (ticks + max_bins - 1) / max_bins);
    histogram.bin_ns = static_cast<double>(histogram.ticks_per_bin) * tick_ns;
  } else {
    histogram.bin_ns = span_ns > 0 ? span_ns / (max_bins - 1) : 1.0;
  }
  std::map<std::int64_t, std::uint64_t> bins;
  for (const auto& c : regular_bins) {
    const auto bin = histogram.ticks_per_bin > 0
                         ? (c.ticks - first.ticks) / histogram.ticks_per_bin
                         : std::llround((c.interval_ns - first.interval_ns) / histogram.bin_ns);
    bins[bin] += c.count;
  }
  const double origin_ns = first.interval_ns - 0.5 * (tick_ns > 0 ? tick_ns : histogram.bin_ns);
  for (const auto& [bin, count] : bins) {
    const double low_ns = origin_ns + static_cast<double>(bin) * histogram.bin_ns;
    histogram.bars.push_back(
        {1e-3 * low_ns, 1e-3 * (low_ns + histogram.bin_ns), static_cast<double>(count)});
  }
  return histogram;
}

// 12 345 678, with narrow spaces.
std::string grouped(std::uint64_t number) {
  const auto digits = std::to_string(number);
  std::string result;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) {
      result += "\u202f";
    }
    result += digits[i];
  }
  return result;
}

// Three digits or more, in the unit that reads best.
std::string duration(double seconds) {
  if (seconds < 1e-6) {
    return fmt::format("{:.3g} ns", 1e9 * seconds);
  }
  if (seconds < 1e-3) {
    return fmt::format("{:.4g} µs", 1e6 * seconds);
  }
  return fmt::format("{:.4g} ms", 1e3 * seconds);
}

std::string subtitle_of(const analysis::SampleClockStatistics& clock, const Histogram& histogram) {
  if (histogram.total == 0) {
    return "no intervals";
  }
  auto text = fmt::format("{} intervals, mean {:.3f} µs, sd {}, spread {}",
                          grouped(histogram.total), 1e6 * clock.mean_interval_s,
                          duration(clock.sd_s), duration(clock.maximum_s - clock.minimum_s));
  if (histogram.bars.empty()) {
    return text;
  }
  text += fmt::format("; bin {}", duration(1e-9 * histogram.bin_ns));
  if (histogram.ticks_per_bin > 0) {
    text += fmt::format(" = {} tick{}", histogram.ticks_per_bin,
                        histogram.ticks_per_bin == 1 ? "" : "s");
  }
  if (histogram.outside > 0) {
    text +=
        fmt::format("; {} beyond the axis (lost or doubled samples)", grouped(histogram.outside));
  }
  return text;
}

std::string csv_of(const PictureTitle& title, const analysis::SampleClockStatistics& clock) {
  auto csv = csv_comment(title.title) + csv_comment("tick " + csv_number(clock.tick_s) + " s");
  csv += "interval_ticks,interval_ns,count\n";
  for (const auto& c : clock.histogram) {
    fmt::format_to(std::back_inserter(csv), "{},{},{}\n", c.ticks, csv_number(c.interval_ns),
                   c.count);
  }
  return csv;
}

} // namespace

Figure interval_histogram_figure(const PictureTitle& title,
                                 const analysis::SampleClockStatistics& clock,
                                 const std::string& name) {
  const auto histogram = merge_bins(clock);
  Panel panel;
  panel.x_label = "sample interval in µs";
  panel.y_label = "count per bin";
  panel.y_scale = Scale::logarithmic;
  panel.bars = histogram.bars;
  // A single count stays visible above the bottom of the axis.
  Range counts(Scale::logarithmic);
  counts.include(0.6);
  counts.include(6);
  for (const auto& bar : panel.bars) {
    counts.include(1.7 * bar.height);
  }
  panel.y_range = counts;

  Picture picture{.title = {title.title, subtitle_of(clock, histogram)},
                  .panel_height = panel_height};
  picture.panels.push_back(std::move(panel));
  return {name, std::move(picture), csv_of(title, clock)};
}

} // namespace dyncal::inline views::figures
