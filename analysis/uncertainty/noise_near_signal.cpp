#include "analysis/uncertainty/noise_near_signal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t min_blocks = 16;
constexpr double narrows_quantile = -3.719; // once in 10^4
constexpr double wanders_quantile = 4.265;  // once in 10^5
constexpr double near_a_line = 0.75;        // 1 / T: nearer, a bin has what the fit left of it
// Enough for 4 p bins: the mean over one of them is hardly less than the coefficient there.
constexpr std::size_t time_bins = 128;

// Means of the residuals over equal parts of the record.
class SlowResiduals {
public:
  SlowResiduals(const Frequency& frequency, std::int64_t phase_origin_ns,
                std::span<const std::int64_t> stamps_ns, std::span<const double> values,
                const SineFit& fit)
      : samples_(static_cast<double>(stamps_ns.size())) {
    std::vector<double> sine(stamps_ns.size()), cosine(stamps_ns.size());
    fill_sine_cosine(frequency, phase_origin_ns, stamps_ns, sine.data(), cosine.data());
    const double span_ns = static_cast<double>(stamps_ns.back() - stamps_ns.front()) + 1.0;
    for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
      const double part = static_cast<double>(stamps_ns[i] - stamps_ns.front()) / span_ns;
      sums_[static_cast<std::size_t>(part * time_bins)] +=
          values[i] - fit.sine * sine[i] - fit.cosine * cosine[i] - fit.offset;
    }
  }

  // Variance of one component of the coefficient at j / T.
  [[nodiscard]] double variance_at(int j) const {
    Complex sum;
    for (std::size_t b = 0; b < time_bins; ++b) {
      const double turns = (static_cast<double>(b) + 0.5) / static_cast<double>(time_bins) * j;
      sum += sums_[b] * std::polar(1.0, -2.0 * std::numbers::pi * turns);
    }
    return 0.5 * std::norm(2.0 / samples_ * sum);
  }

private:
  double samples_;
  std::array<double, time_bins> sums_{};
};

struct Density {
  double sum = 0.0;
  double bins = 0.0;

  [[nodiscard]] double freedom() const { return 2.0 * bins; }
  [[nodiscard]] double ratio(double white) const { return sum / bins / white; }
};

} // namespace

NoiseNearSignal noise_from_blocks(std::span<const PhasorBlock> blocks, const SineFit& fit) {
  if (blocks.size() < min_blocks || !(fit.residual_sd() > 0.0)) {
    return {};
  }
  const double m = static_cast<double>(blocks.size());
  Complex mean;
  double unit_variance = 0.0;
  for (const PhasorBlock& block : blocks) {
    mean += block.phasor / m;
    unit_variance += block.unit_variance / m;
  }
  double squares = 0.0;
  for (const PhasorBlock& block : blocks) {
    squares += std::norm(block.phasor - mean);
  }
  const double freedom = 2.0 * (m - 1.0);
  const double white = fit.residual_sd() * fit.residual_sd();
  const double ratio = squares / freedom / (white * unit_variance);
  if (ratio < chi_squared_limit(freedom, narrows_quantile)) {
    return {false, std::sqrt(ratio), freedom};
  }
  // What blocks of their own phasor and constant take from the residuals, beside chance.
  const NoiseWithinBlocks within = noise_within(blocks);
  const double taken = fit.degrees_of_freedom - within.degrees_of_freedom;
  const bool wanders =
      taken > 0.0 &&
      fit.rss - within.rss > taken * within.variance * chi_squared_limit(taken, wanders_quantile);
  return wanders
             ? NoiseNearSignal{false, std::sqrt(within.variance / white), within.degrees_of_freedom}
             : NoiseNearSignal{};
}

NoiseNearSignal noise_of_few_periods(const Frequency& frequency, std::int64_t phase_origin_ns,
                                     std::span<const std::int64_t> stamps_ns,
                                     std::span<const double> values, const SineFit& fit) {
  if (stamps_ns.size() < 4 * time_bins / 2 || !(fit.residual_sd() > 0.0)) {
    return {};
  }
  const double periods =
      frequency.hz() * static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  const SlowResiduals residuals(frequency, phase_origin_ns, stamps_ns, values, fit);
  Density near, slow;
  for (int j = 1; j < std::min(4.0 * periods, 0.25 * time_bins); ++j) {
    const double order = std::max(1.0, std::round(j / periods));
    if (std::abs(j - order * periods) < near_a_line) {
      continue;
    }
    const double variance = residuals.variance_at(j);
    slow.sum += variance;
    slow.bins += 1.0;
    if (j < std::max(2.0 * periods, 4.0)) {
      near.sum += variance;
      near.bins += 1.0;
    }
  }
  if (near.bins < 1.0) {
    return {};
  }
  const double white =
      2.0 * fit.residual_sd() * fit.residual_sd() / static_cast<double>(stamps_ns.size());
  const double ratio = near.ratio(white);
  const bool larger = ratio > chi_squared_limit(near.freedom(), once_in_a_thousand) ||
                      slow.ratio(white) > chi_squared_limit(slow.freedom(), once_in_a_thousand);
  const bool smaller = ratio < chi_squared_limit(near.freedom(), -once_in_a_thousand);
  return (larger && ratio > 1.0) || smaller
             ? NoiseNearSignal{false, std::sqrt(ratio), near.freedom()}
             : NoiseNearSignal{};
}

} // namespace dyncal::analysis
