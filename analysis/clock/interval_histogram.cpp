#include "analysis/clock/interval_histogram.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

namespace dyncal::analysis {
namespace {

constexpr std::size_t max_bins = 4096;
constexpr std::int64_t max_array = 1 << 20;
constexpr int deconvolution_steps = 5;
constexpr std::array kernel{1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0};

std::vector<double> convolve(const std::vector<double>& values) {
  std::vector<double> result(values.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      if (i + k >= 1 && i + k - 1 < values.size()) {
        result[i] += kernel[k] * values[i + k - 1];
      }
    }
  }
  return result;
}

std::vector<double> deconvolved(const std::vector<double>& counts) {
  std::vector<double> estimate = counts;
  for (int step = 0; step < deconvolution_steps; ++step) {
    const std::vector<double> expected = convolve(estimate);
    std::vector<double> ratio(counts.size(), 0.0);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (expected[i] > 0.0) {
        ratio[i] = counts[i] / expected[i];
      }
    }
    const std::vector<double> correction = convolve(ratio);
    for (std::size_t i = 0; i < estimate.size(); ++i) {
      estimate[i] *= correction[i];
    }
  }
  return estimate;
}

// Places of the peaks: each is taken back unless the way to any higher ground leads through a
// valley that is deep enough.
std::vector<std::size_t> significant_peaks(const std::vector<double>& shape,
                                           const std::vector<double>& counts) {
  std::vector<std::size_t> peaks;
  std::size_t candidate = 0;
  double valley = 0.0;
  bool rising = true; // towards a candidate; else down from it
  const auto depth = [&](std::size_t peak) {
    return std::max(5.0 * std::sqrt(std::max(1.0, counts[peak])), 0.02 * shape[peak]);
  };
  for (std::size_t i = 1; i < shape.size(); ++i) {
    if (rising) {
      if (shape[i] > shape[candidate]) {
        candidate = i;
      }
      if (shape[i] < shape[candidate] - depth(candidate)) {
        peaks.push_back(candidate);
        rising = false;
        valley = shape[i];
      }
    } else {
      valley = std::min(valley, shape[i]);
      if (shape[i] > valley + depth(i)) {
        rising = true;
        candidate = i;
      }
    }
  }
  return peaks;
}

} // namespace

IntervalHistogram interval_histogram(const IntervalDistribution& distribution, double tick_ns,
                                     double robust_sd_ns) {
  const double unit_ns = tick_ns > 0.0 ? tick_ns : std::max(1.0, std::floor(0.25 * robust_sd_ns));
  for (std::int64_t width = 1;; width *= 2) {
    std::map<std::int64_t, std::uint64_t> bins;
    for (const auto& [length, times] : distribution.entries()) {
      bins[width * std::llround(static_cast<double>(length) /
                                (unit_ns * static_cast<double>(width)))] += times;
    }
    if (bins.size() > max_bins) {
      continue;
    }
    IntervalHistogram result{unit_ns * static_cast<double>(width), {}};
    for (const auto& [ticks, times] : bins) {
      result.bins.push_back({ticks, static_cast<double>(ticks) * unit_ns, times});
    }
    return result;
  }
}

double lattice_statistic(const IntervalDistribution& distribution, double tick_ns) {
  if (!(tick_ns > 0.0)) {
    return 0.0;
  }
  std::complex<double> sum;
  for (const auto& [length, times] : distribution.entries()) {
    const double turns = std::remainder(static_cast<double>(length), tick_ns) / tick_ns;
    sum += static_cast<double>(times) * std::polar(1.0, 2.0 * std::numbers::pi * turns);
  }
  return std::abs(sum) / static_cast<double>(distribution.count());
}

std::vector<double> interval_modes_ns(const IntervalHistogram& histogram) {
  const auto index = [&](const IntervalHistogramBin& bin) {
    return std::llround(bin.interval_ns / histogram.bin_ns);
  };
  const std::int64_t first = index(histogram.bins.front()) - 2;
  const std::int64_t length =
      std::min<std::int64_t>(index(histogram.bins.back()) + 3 - first, max_array);
  std::vector<double> counts(static_cast<std::size_t>(length), 0.0);
  for (const IntervalHistogramBin& bin : histogram.bins) {
    if (index(bin) - first < length) {
      counts[static_cast<std::size_t>(index(bin) - first)] = static_cast<double>(bin.count);
    }
  }
  std::vector<double> modes;
  for (const std::size_t peak : significant_peaks(deconvolved(counts), counts)) {
    modes.push_back(static_cast<double>(static_cast<std::int64_t>(peak) + first) *
                    histogram.bin_ns);
  }
  return modes;
}

} // namespace dyncal::analysis
