#include "analysis/uncertainty/block_drift.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {
namespace {

using Values = std::vector<double>;

constexpr std::size_t highest_order = 3;
constexpr double certain_quantile = 2.576; // once in 10^2

double mean_product(const Values& a, const Values& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    sum += a[k] * b[k];
  }
  return sum / static_cast<double>(a.size());
}

void subtract(Values& from, const Values& values, double factor) {
  for (std::size_t k = 0; k < from.size(); ++k) {
    from[k] -= factor * values[k];
  }
}

// 1 first, of mean square 1; two blocks more than orders, so that something is left.
std::vector<Values> orthogonal_polynomials(const BlockSeries& series) {
  const std::size_t blocks = series.time_s.size();
  const double first_s = series.time_s.front();
  const double half_s = 0.5 * (series.time_s.back() - first_s);
  std::vector<Values> polynomials{Values(blocks, 1.0)};
  for (std::size_t order = 1; order <= std::min(highest_order, blocks - 3); ++order) {
    Values next = polynomials.back();
    for (std::size_t k = 0; k < blocks; ++k) {
      next[k] *= (series.time_s[k] - first_s) / half_s - 1.0;
    }
    for (const Values& lower : polynomials) {
      subtract(next, lower, mean_product(next, lower));
    }
    const double norm = std::sqrt(mean_product(next, next));
    for (double& value : next) {
      value /= norm;
    }
    polynomials.push_back(std::move(next));
  }
  return polynomials;
}

double drift_of(Values values, const std::vector<Values>& polynomials, double white_variance) {
  Values coefficients;
  for (const Values& polynomial : polynomials) {
    coefficients.push_back(mean_product(values, polynomial));
    subtract(values, polynomial, coefficients.back());
  }
  const double blocks = static_cast<double>(values.size());
  const double freedom = blocks - static_cast<double>(polynomials.size());
  const double variance =
      std::max(white_variance, mean_product(values, values) * blocks / freedom) / blocks;
  double squares = 0.0;
  for (std::size_t order = 1; order < coefficients.size(); ++order) {
    const double square = coefficients[order] * coefficients[order];
    if (square > certain_quantile * certain_quantile * variance) {
      squares += square;
    }
  }
  return std::sqrt(squares);
}

} // namespace

BlockDrift drift_of(const BlockSeries& series) {
  if (series.time_s.size() < min_blocks_of_series) {
    return {};
  }
  const std::vector<Values> polynomials = orthogonal_polynomials(series);
  Values magnitude, phase;
  for (const std::complex<double>& value : series.log_ratio) {
    magnitude.push_back(value.real());
    phase.push_back(value.imag());
  }
  return {drift_of(std::move(magnitude), polynomials, series.variance_magnitude),
          drift_of(std::move(phase), polynomials, series.variance_phase)};
}

} // namespace dyncal::analysis
