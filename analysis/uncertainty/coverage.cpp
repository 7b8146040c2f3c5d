#include "analysis/uncertainty/coverage.hpp"

#include <cmath>
#include <limits>

namespace dyncal::analysis {
namespace {

// Continued fraction of the incomplete beta function (Lentz); converges fast for x < (a + 1) / (a +
// b + 2).
double beta_fraction(double a, double b, double x) {
  constexpr double tiny = 1e-300;
  const auto away_from_zero = [](double value) { return std::abs(value) < tiny ? tiny : value; };
  double c = 1.0;
  double d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
  double result = d;
  for (int i = 1; i <= 500; ++i) {
    const double m = i;
    const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
    d = 1.0 / away_from_zero(1.0 + even * d);
    c = away_from_zero(1.0 + even / c);
    result *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
    d = 1.0 / away_from_zero(1.0 + odd * d);
    c = away_from_zero(1.0 + odd / c);
    result *= d * c;
    if (std::abs(d * c - 1.0) < 1e-16) {
      break;
    }
  }
  return result;
}

double regularised_beta(double a, double b, double x) {
  if (x <= 0.0) {
    return 0.0;
  }
  if (x >= 1.0) {
    return 1.0;
  }
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1.0) / (a + b + 2.0)) {
    return front * beta_fraction(a, b, x) / a;
  }
  return 1.0 - front * beta_fraction(b, a, 1.0 - x) / b;
}

double probability_outside(double t, double degrees_of_freedom) {
  return regularised_beta(0.5 * degrees_of_freedom, 0.5,
                          degrees_of_freedom / (degrees_of_freedom + t * t));
}

} // namespace

double student_probability(double t, double degrees_of_freedom) {
  if (std::isinf(degrees_of_freedom)) {
    return 0.5 * std::erfc(-t / std::sqrt(2.0));
  }
  const double tail = 0.5 * probability_outside(t, degrees_of_freedom);
  return t > 0.0 ? 1.0 - tail : tail;
}

double coverage_factor(double degrees_of_freedom, double probability) {
  if (!(degrees_of_freedom > 0.0)) {
    return std::numeric_limits<double>::infinity();
  }
  // Beyond this the difference to the normal distribution is below the rounding of the incomplete
  // beta function.
  const bool infinite = degrees_of_freedom > 1e7;
  const auto outside = [&](double t) {
    return infinite ? std::erfc(t / std::sqrt(2.0)) : probability_outside(t, degrees_of_freedom);
  };
  const double wanted = 1.0 - probability;
  double low = 0.0, high = 2.0;
  while (outside(high) > wanted && high < 1e12) {
    low = high;
    high *= 2.0;
  }
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (outside(middle) > wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double effective_degrees_of_freedom(std::span<const UncertaintyPart> parts) {
  double variance = 0.0, weighted = 0.0;
  for (const UncertaintyPart& part : parts) {
    variance += part.u * part.u;
    weighted += std::pow(part.u, 4) / part.degrees_of_freedom;
  }
  return weighted > 0.0 ? variance * variance / weighted : infinite_degrees_of_freedom;
}

CombinedUncertainty combine(std::span<const UncertaintyPart> parts) {
  CombinedUncertainty result;
  for (const UncertaintyPart& part : parts) {
    result.u = std::hypot(result.u, part.u);
  }
  const double freedom = effective_degrees_of_freedom(parts);
  if (!(result.u > 0.0) || std::isinf(freedom)) {
    return result;
  }
  double expanded = 0.0;
  for (const UncertaintyPart& part : parts) {
    expanded = std::hypot(expanded,
                          part.u > 0.0 ? coverage_factor(part.degrees_of_freedom) * part.u : 0.0);
  }
  result.degrees_of_freedom = freedom;
  result.k = coverage_factor(freedom);
  result.k += (expanded / result.u - result.k) / 3.0;
  return result;
}

} // namespace dyncal::analysis
