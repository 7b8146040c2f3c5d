#include "analysis/sine/frequency_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <unsupported/Eigen/FFT>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t min_samples = 8;
constexpr std::size_t max_grid = std::size_t{1} << 20U;

Expected<std::int64_t> median_interval_ns(std::span<const std::int64_t> stamps_ns) {
  std::vector<std::int64_t> intervals;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    intervals.push_back(stamps_ns[i] - stamps_ns[i - 1]);
    if (intervals.back() <= 0) {
      return fail(ErrorCode::stamps_not_increasing,
                  "a stamp is not later than the one before it (sample " + std::to_string(i) + ")");
    }
  }
  return upper_median(intervals);
}

// Hann-windowed and free of its mean; empty when the column is constant.
std::vector<double> on_grid(std::span<const std::size_t> places, std::span<const double> values,
                            std::size_t size) {
  const auto used = values.first(places.size());
  if (std::all_of(used.begin(), used.end(), [&](double v) { return v == used.front(); })) {
    return {}; // the mean may differ from the value by rounding
  }
  double mean = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    mean += values[i] / static_cast<double>(places.size());
  }
  std::vector<double> grid(size, 0.0);
  double power = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double deviation = values[i] - mean;
    power += deviation * deviation;
    const double window =
        1.0 - std::cos(2.0 * std::numbers::pi * (static_cast<double>(places[i]) + 0.5) /
                       static_cast<double>(size));
    grid[places[i]] = deviation * window;
  }
  if (!(power > 0.0)) {
    return {};
  }
  const double scale = 1.0 / std::sqrt(power);
  std::transform(grid.begin(), grid.end(), grid.begin(),
                 [&](double value) { return value * scale; });
  return grid;
}

// The line between bins: with a Hann window the two largest neighbours are in the ratio (1 + d) /
// (2 - d) of their distance d.
double interpolated_bin(const std::vector<double>& power, std::size_t peak) {
  const double left = std::sqrt(power[peak - 1]);
  const double right = peak + 1 < power.size() ? std::sqrt(power[peak + 1]) : 0.0;
  const double ratio = std::max(left, right) / std::sqrt(power[peak]);
  const double distance = (2.0 * ratio - 1.0) / (ratio + 1.0);
  return static_cast<double>(peak) + (right >= left ? distance : -distance);
}

} // namespace

Expected<Frequency> estimate_frequency(std::span<const std::int64_t> stamps_ns,
                                       std::span<const std::span<const double>> columns) {
  if (stamps_ns.size() < min_samples) {
    return fail(ErrorCode::too_few_samples, "a frequency estimate needs at least eight samples");
  }
  const auto interval_ns = median_interval_ns(stamps_ns);
  if (!interval_ns) {
    return fail(interval_ns.error());
  }
  std::vector<std::size_t> places;
  for (const std::int64_t stamp : stamps_ns) {
    const auto place =
        static_cast<std::size_t>((stamp - stamps_ns.front() + *interval_ns / 2) / *interval_ns);
    if (place >= max_grid) {
      break;
    }
    places.push_back(place);
  }
  const std::size_t size = places.back() + 1;
  std::vector<double> power(size / 2 + 1, 0.0);
  bool excited = false;
  Eigen::FFT<double> transform;
  for (const std::span<const double> column : columns) {
    if (column.size() != stamps_ns.size()) {
      return fail(ErrorCode::invalid_argument,
                  "the numbers of stamps and of values of a column differ");
    }
    if (!std::all_of(column.begin(), column.end(),
                     [](double value) { return std::isfinite(value); })) {
      return fail(ErrorCode::not_finite, "a value is not a finite number");
    }
    const std::vector<double> grid = on_grid(places, column, size);
    if (grid.empty()) {
      continue;
    }
    excited = true;
    std::vector<std::complex<double>> spectrum;
    transform.fwd(spectrum, grid);
    for (std::size_t bin = 0; bin < power.size(); ++bin) {
      power[bin] += std::norm(spectrum[bin]);
    }
  }
  if (!excited) {
    return fail(ErrorCode::no_excitation, "all values are the same: there is no sine to find");
  }
  const auto peak =
      static_cast<std::size_t>(std::max_element(power.begin() + 1, power.end()) - power.begin());
  const double bin = std::max(interpolated_bin(power, peak), 0.5);
  return Frequency::from_hz(bin * 1e9 /
                            (static_cast<double>(size) * static_cast<double>(*interval_ns)));
}

} // namespace dyncal::analysis
