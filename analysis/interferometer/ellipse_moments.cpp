#include "analysis/interferometer/ellipse_moments.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace dyncal::analysis {
namespace {

constexpr std::size_t moments_block = 1024;
constexpr double fourth_difference_gain = 70.0; // 1 + 16 + 36 + 16 + 1

// The order of the kernel's sums.
constexpr std::size_t moment_exponents[kernel::quadrature_moments][2] = {
    {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}, {3, 0}, {2, 1},
    {1, 2}, {0, 3}, {4, 0}, {3, 1}, {2, 2}, {1, 3}, {0, 4}};

using PowerMatrix = std::array<std::array<double, 5>, 5>;

// Row i: ((x - shift) * factor)^i in powers of x.
PowerMatrix shifted_powers(double shift, double factor) {
  PowerMatrix rows{};
  rows[0][0] = 1.0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    for (std::size_t a = 0; a < i; ++a) {
      rows[i][a] -= rows[i - 1][a] * shift * factor;
      rows[i][a + 1] += rows[i - 1][a] * factor;
    }
  }
  return rows;
}

template <class Number>
SignalRange range_of_signal(std::span<const Number> values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {static_cast<double>(*low), static_cast<double>(*high)};
}

void widen(SignalRange& range, const SignalRange& other, bool first) {
  range =
      first ? other : SignalRange{std::min(range.low, other.low), std::max(range.high, other.high)};
}

SignalScale scale_of(const SignalRange& range) {
  return {range.middle(), range.half() > 0.0 ? range.half() : 1.0};
}

double white_variance(double difference_squares, std::uint64_t differences) {
  return differences == 0
             ? 0.0
             : difference_squares / (fourth_difference_gain * static_cast<double>(differences));
}

double mean_of_order(std::size_t i, std::size_t j, const QuadratureMeans& means,
                     const PowerMatrix& powers_1, const PowerMatrix& powers_2) {
  double sum = 0.0;
  for (std::size_t a = 0; a <= i; ++a) {
    for (std::size_t b = 0; b <= j; ++b) {
      sum += powers_1[i][a] * powers_2[j][b] * means[a][b];
    }
  }
  return sum;
}

} // namespace

template <class Number>
void EllipseMoments::add_samples(std::span<const Number> u1, std::span<const Number> u2) {
  assert(u1.size() == u2.size());
  if (u1.empty()) {
    return;
  }
  widen(range_1_, range_of_signal(u1), samples_ == 0);
  widen(range_2_, range_of_signal(u2), samples_ == 0);
  if (samples_ == 0) {
    scale_1_ = scale_of(range_1_);
    scale_2_ = scale_of(range_2_);
  }
  const kernel::QuadratureKernel& best = kernel::best_quadrature_kernel();
  alignas(64) double x[moments_block];
  alignas(64) double y[moments_block];
  for (std::size_t begin = 0; begin < u1.size(); begin += moments_block) {
    const std::size_t n = std::min(moments_block, u1.size() - begin);
    const std::size_t whole =
        (n + kernel::quadrature_lanes - 1) / kernel::quadrature_lanes * kernel::quadrature_lanes;
    const double factor_1 = 1.0 / scale_1_.scale;
    const double factor_2 = 1.0 / scale_2_.scale;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = (static_cast<double>(u1[begin + i]) - scale_1_.centre) * factor_1;
      y[i] = (static_cast<double>(u2[begin + i]) - scale_2_.centre) * factor_2;
    }
    std::fill(x + n, x + whole, 0.0);
    std::fill(y + n, y + whole, 0.0);
    best.moments(x, y, whole, sums_.data());
    const std::size_t differences =
        n < 4 ? 0 : (n - 4) / kernel::quadrature_lanes * kernel::quadrature_lanes;
    difference_squares_1_ +=
        best.fourth_difference_squares(x, differences) * scale_1_.scale * scale_1_.scale;
    difference_squares_2_ +=
        best.fourth_difference_squares(y, differences) * scale_2_.scale * scale_2_.scale;
    differences_ += differences;
  }
  samples_ += u1.size();
}

void EllipseMoments::add(std::span<const std::int16_t> u1, std::span<const std::int16_t> u2) {
  add_samples(u1, u2);
}

void EllipseMoments::add(std::span<const float> u1, std::span<const float> u2) {
  add_samples(u1, u2);
}

void EllipseMoments::add(std::span<const double> u1, std::span<const double> u2) {
  add_samples(u1, u2);
}

void EllipseMoments::add(const EllipseMoments& other) {
  if (other.samples_ == 0) {
    return;
  }
  if (samples_ == 0) {
    *this = other;
    return;
  }
  const QuadratureMeans means = other.means(scale_1_, scale_2_);
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    const auto& [i, j] = moment_exponents[k];
    sums_[k] += means[i][j] * static_cast<double>(other.samples_);
  }
  widen(range_1_, other.range_1_, false);
  widen(range_2_, other.range_2_, false);
  samples_ += other.samples_;
  differences_ += other.differences_;
  difference_squares_1_ += other.difference_squares_1_;
  difference_squares_2_ += other.difference_squares_2_;
}

double EllipseMoments::difference_variance_1() const {
  return white_variance(difference_squares_1_, differences_);
}

double EllipseMoments::difference_variance_2() const {
  return white_variance(difference_squares_2_, differences_);
}

QuadratureMeans EllipseMoments::means(const SignalScale& scale_1,
                                      const SignalScale& scale_2) const {
  assert(samples_ > 0);
  QuadratureMeans own{};
  own[0][0] = 1.0;
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    const auto& [i, j] = moment_exponents[k];
    own[i][j] = sums_[k] / static_cast<double>(samples_);
  }
  const auto powers = [](const SignalScale& from, const SignalScale& to) {
    return shifted_powers((to.centre - from.centre) / from.scale, from.scale / to.scale);
  };
  const PowerMatrix powers_1 = powers(scale_1_, scale_1);
  const PowerMatrix powers_2 = powers(scale_2_, scale_2);
  QuadratureMeans result{};
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (std::size_t j = 0; i + j < result.size(); ++j) {
      result[i][j] = mean_of_order(i, j, own, powers_1, powers_2);
    }
  }
  return result;
}

SignalScale EllipseMoments::own_scale_1() const {
  const double mean = sums_[0] / static_cast<double>(samples_);
  return {scale_1_.centre + mean * scale_1_.scale, range_1_.half()};
}

SignalScale EllipseMoments::own_scale_2() const {
  const double mean = sums_[1] / static_cast<double>(samples_);
  return {scale_2_.centre + mean * scale_2_.scale, range_2_.half()};
}

} // namespace dyncal::analysis
