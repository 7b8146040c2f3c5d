#include "analysis/uncertainty/ratio_scatter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

constexpr double min_blocks = 4.0;
constexpr double max_blocks = 16.0;
constexpr double weakest_snr = 3.0;

std::complex<double> phasor(const SineFit& fit) {
  return {fit.sine, fit.cosine};
}

// s / sqrt(m), larger where neighbours resemble each other: of blocks that follow a trend only m (1
// - r) / (1 + r) are independent, r being their correlation.
double scatter_of_mean(const std::vector<double>& values) {
  const double n = static_cast<double>(values.size());
  double mean = 0.0;
  for (double value : values) {
    mean += value / n;
  }
  double squares = 0.0, products = 0.0, before = 0.0;
  for (double value : values) {
    squares += (value - mean) * (value - mean);
    products += (value - mean) * before;
    before = value - mean;
  }
  const double correlation = squares > 0.0 ? std::min(products / squares, 0.9) : 0.0;
  const bool resembling = correlation > 2.0 / std::sqrt(n);
  return std::sqrt(squares / (n - 1.0) / n *
                   (resembling ? (1.0 + correlation) / (1.0 - correlation) : 1.0));
}

} // namespace

std::optional<RatioScatter> ratio_scatter(const Frequency& frequency,
                                          std::span<const std::int64_t> stamps_ns,
                                          std::span<const double> numerator,
                                          std::span<const double> denominator) {
  if (stamps_ns.size() < 2) {
    return std::nullopt;
  }
  const double period_ns = 1e9 / frequency.hz();
  const double periods =
      std::floor(static_cast<double>(stamps_ns.back() - stamps_ns.front()) / period_ns);
  const double blocks = std::min(periods, max_blocks);
  if (blocks < min_blocks) {
    return std::nullopt;
  }
  const double block_ns = std::floor(periods / blocks) * period_ns;

  std::vector<double> magnitudes;
  std::vector<std::complex<double>> ratios;
  auto first = stamps_ns.begin();
  for (double k = 1.0; k <= blocks; k += 1.0) {
    const auto last =
        std::lower_bound(first, stamps_ns.end(), stamps_ns.front() + std::llround(k * block_ns));
    const auto begin = static_cast<std::size_t>(first - stamps_ns.begin());
    const auto count = static_cast<std::size_t>(last - first);
    const std::array channels{numerator.subspan(begin, count), denominator.subspan(begin, count)};
    const auto fits =
        fit_sine(frequency, stamps_ns.front(), stamps_ns.subspan(begin, count), channels);
    if (!fits) {
      return std::nullopt;
    }
    for (const SineFit& fit : *fits) {
      if (!(fit.amplitude() > weakest_snr * fit.u_amplitude())) {
        return std::nullopt;
      }
    }
    magnitudes.push_back((*fits)[0].amplitude());
    ratios.push_back(phasor((*fits)[0]) * std::conj(phasor((*fits)[1])));
    first = last;
  }

  std::complex<double> mean_ratio;
  double mean_magnitude = 0.0;
  for (std::size_t k = 0; k < ratios.size(); ++k) {
    mean_ratio += ratios[k] / std::abs(ratios[k]);
    mean_magnitude += magnitudes[k] / blocks;
  }
  std::vector<double> phases;
  phases.reserve(ratios.size());
  for (const std::complex<double>& ratio : ratios) {
    phases.push_back(std::arg(ratio * std::conj(mean_ratio)));
  }
  return RatioScatter{scatter_of_mean(magnitudes) / mean_magnitude, scatter_of_mean(phases),
                      blocks - 1.0};
}

double significant_excess(double observed, double expected, double degrees_of_freedom) {
  // Chi-squared / dof that is exceeded once in a thousand (Wilson and Hilferty).
  constexpr double normal_quantile = 3.0902;
  const double spread = 2.0 / (9.0 * degrees_of_freedom);
  const double limit = std::pow(1.0 - spread + normal_quantile * std::sqrt(spread), 3.0);
  const double ratio = observed * observed - limit * expected * expected;
  return ratio > 0.0 ? std::sqrt(observed * observed - expected * expected) : 0.0;
}

} // namespace dyncal::analysis
