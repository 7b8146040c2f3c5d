#include "analysis/uncertainty/mean_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dyncal::analysis {
namespace {

constexpr double one_sigma_probability = 0.68268949213708590;

// Half the interval that holds `probability`.
double half_interval(const MeanError& error, double u_common, double probability) {
  const auto outside = [&](double half) {
    double sum = 0.0;
    for (const MeanError::Part& part : error.parts) {
      sum += part.weight * std::erfc(half / std::sqrt(2.0 * (part.variance + u_common * u_common)));
    }
    return sum;
  };
  double low = 0.0;
  double high = std::hypot(std::sqrt(error.parts.front().variance), u_common);
  while (outside(high) > 1.0 - probability) {
    low = high;
    high *= 2.0;
  }
  for (int i = 0; i < 100 && high - low > 1e-9 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (outside(middle) > 1.0 - probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Degrees of freedom of Student's t by the quotient of its 95.45 % and 68.27 % intervals.
double degrees_of_freedom_of(double quotient) {
  struct Entry {
    double log_freedom, log_excess;
  };
  constexpr double first = -1.0; // logarithm of the degrees of freedom
  constexpr double step = 0.1;
  static const std::array<Entry, 131> table = [] {
    std::array<Entry, 131> entries{};
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const double log_freedom = first + step * static_cast<double>(i);
      const double freedom = std::exp(log_freedom);
      entries[i] = {log_freedom, std::log(coverage_factor(freedom) /
                                              coverage_factor(freedom, one_sigma_probability) -
                                          2.0)};
    }
    return entries;
  }();
  const double log_excess = std::log(std::max(quotient - 2.0, 1e-300));
  if (log_excess <= table.back().log_excess) {
    return infinite_degrees_of_freedom;
  }
  const auto above = std::find_if(table.begin() + 1, table.end() - 1, [&](const Entry& entry) {
    return entry.log_excess <= log_excess;
  });
  const Entry& below = *(above - 1);
  const double part =
      std::max(0.0, (log_excess - below.log_excess) / (above->log_excess - below.log_excess));
  return std::exp(below.log_freedom + part * step);
}

} // namespace

CombinedUncertainty combine(const MeanError& error, double u_common) {
  if (error.parts.empty()) {
    return combine(std::array{error.student, UncertaintyPart{u_common}});
  }
  if (error.parts.size() == 1) {
    return {std::hypot(std::sqrt(error.parts.front().variance), u_common)};
  }
  const double expanded = half_interval(error, u_common, two_sigma_probability);
  CombinedUncertainty result;
  result.degrees_of_freedom =
      degrees_of_freedom_of(expanded / half_interval(error, u_common, one_sigma_probability));
  result.k = coverage_factor(result.degrees_of_freedom);
  result.u = expanded / result.k;
  return result;
}

} // namespace dyncal::analysis
