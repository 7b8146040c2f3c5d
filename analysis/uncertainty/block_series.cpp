#include "analysis/uncertainty/block_series.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t min_blocks = min_blocks_of_series;
constexpr double weakest_snr = 5.0;       // of a block: below, its logarithm is not normal any more
constexpr double varies_quantile = 4.265; // once in 10^5

// Means of `group` neighbours; what is left over at the end is left out.
BlockSeries grouped(const BlockSeries& series, std::size_t group) {
  if (group < 2) {
    return series;
  }
  BlockSeries result;
  const double part = 1.0 / static_cast<double>(group);
  for (std::size_t i = 0; i + group <= series.time_s.size(); i += group) {
    double time_s = 0.0;
    Complex sum;
    for (std::size_t k = i; k < i + group; ++k) {
      time_s += series.time_s[k] * part;
      sum += series.log_ratio[k] * part;
    }
    result.time_s.push_back(time_s);
    result.log_ratio.push_back(sum);
  }
  result.variance_magnitude = series.variance_magnitude * part;
  result.variance_phase = series.variance_phase * part;
  result.varies = series.varies;
  result.shortening = series.shortening;
  return result;
}

// The phase advances by `b` over a block of noise-free signal: sinc(b / 2) = 1 - b^2 / 24.
double shortening_of(const std::vector<Complex>& log_ratio, double variance) {
  double squares = 0.0;
  for (std::size_t k = 2; k < log_ratio.size(); ++k) {
    squares += std::pow(0.5 * (log_ratio[k].imag() - log_ratio[k - 2].imag()), 2);
  }
  const double mean = squares / static_cast<double>(log_ratio.size() - 2);
  return std::max(0.0, mean - 2.0 * variance) / 24.0;
}

// Whether blocks of different phase add to a phasor that is shorter by a tenth of its noise.
bool shortens(const BlockSeries& series) {
  constexpr double negligible = 0.1;
  const double blocks = static_cast<double>(series.time_s.size());
  const double mean = mean_of(series.log_ratio).imag();
  double squares = 0.0;
  for (const Complex& value : series.log_ratio) {
    squares += std::pow(value.imag() - mean, 2);
  }
  const double loss = 0.5 * (squares / blocks - series.variance_phase);
  return varies(series) && loss > negligible * std::sqrt(series.variance_magnitude / blocks);
}

} // namespace

double spacing_s(const BlockSeries& series) {
  return (series.time_s.back() - series.time_s.front()) /
         static_cast<double>(series.time_s.size() - 1);
}

void make_alike(BlockSeries& one, BlockSeries& other) {
  const double a = spacing_s(one), b = spacing_s(other);
  one = grouped(one, static_cast<std::size_t>(std::max(1.0, std::round(b / a))));
  other = grouped(other, static_cast<std::size_t>(std::max(1.0, std::round(a / b))));
}

std::optional<Complex> value_at(const BlockSeries& series, double time_s) {
  const auto& times = series.time_s;
  const double margin_s = 0.5 * spacing_s(series);
  if (time_s < times.front() - margin_s || time_s > times.back() + margin_s) {
    return std::nullopt;
  }
  const auto behind = std::clamp<std::ptrdiff_t>(
      std::upper_bound(times.begin(), times.end(), time_s) - times.begin(), 1,
      static_cast<std::ptrdiff_t>(times.size()) - 1);
  const auto i = static_cast<std::size_t>(behind);
  // Noise of an end is not to be extrapolated.
  const double part = std::clamp((time_s - times[i - 1]) / (times[i] - times[i - 1]), 0.0, 1.0);
  return (1.0 - part) * series.log_ratio[i - 1] + part * series.log_ratio[i];
}

double chi_squared(std::span<const Complex> values, Complex mean, double variance_magnitude,
                   double variance_phase) {
  double sum = 0.0;
  for (const Complex& value : values) {
    sum += std::pow(value.real() - mean.real(), 2) / variance_magnitude +
           std::pow(value.imag() - mean.imag(), 2) / variance_phase;
  }
  return sum;
}

Complex mean_of(std::span<const Complex> values) {
  Complex sum;
  for (const Complex& value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

bool varies(const BlockSeries& series) {
  const double freedom = 2.0 * static_cast<double>(series.time_s.size() - 1);
  return chi_squared(series.log_ratio, mean_of(series.log_ratio), series.variance_magnitude,
                     series.variance_phase) > freedom * chi_squared_limit(freedom, varies_quantile);
}

std::optional<BlockSeries> block_series(std::span<const PhasorBlock> blocks, const SineFit& fit) {
  const Complex whole{fit.sine, fit.cosine};
  if (blocks.size() < min_blocks || !(std::abs(whole) > 0.0)) {
    return std::nullopt;
  }
  BlockSeries series;
  double unit_variance = 0.0;
  for (const PhasorBlock& block : blocks) {
    unit_variance += block.unit_variance / static_cast<double>(blocks.size());
  }
  const double variance =
      std::max(noise_within(blocks).variance / std::norm(whole) * unit_variance, 1e-28);
  const double enough = std::ceil(variance * weakest_snr * weakest_snr);
  if (enough * static_cast<double>(min_blocks) > static_cast<double>(blocks.size())) {
    return std::nullopt;
  }
  const auto group = static_cast<std::size_t>(std::max(1.0, enough));
  double before = 0.0;
  for (std::size_t i = 0; i + group <= blocks.size(); i += group) {
    Complex ratio;
    double time_s = 0.0;
    for (std::size_t k = i; k < i + group; ++k) {
      ratio += blocks[k].phasor / whole / static_cast<double>(group);
      time_s += blocks[k].centre_s / static_cast<double>(group);
    }
    before += wrap_phase(std::arg(ratio) - before);
    series.time_s.push_back(time_s);
    series.log_ratio.emplace_back(std::log(std::max(std::abs(ratio), 1e-3)), before);
  }
  series.variance_magnitude = series.variance_phase = variance / static_cast<double>(group);
  series.varies = shortens(series);
  series.shortening = shortening_of(series.log_ratio, series.variance_phase);
  return series;
}

void refer_phase(BlockSeries& series, const BlockSeries& pilot, double offset_s) {
  BlockSeries coarse = pilot;
  make_alike(series, coarse);
  BlockSeries referred;
  for (std::size_t k = 0; k < series.time_s.size(); ++k) {
    if (const auto phase = value_at(coarse, series.time_s[k] + offset_s)) {
      referred.time_s.push_back(series.time_s[k]);
      referred.log_ratio.push_back(series.log_ratio[k] - Complex(0.0, phase->imag()));
    }
  }
  series.time_s = std::move(referred.time_s);
  series.log_ratio = std::move(referred.log_ratio);
  series.variance_phase += coarse.variance_phase;
}

} // namespace dyncal::analysis
