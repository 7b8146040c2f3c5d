#include "analysis/response/chi_squared.hpp"

#include <cmath>

namespace dyncal::analysis {
namespace {

constexpr double negligible = 1e-16;
constexpr int max_terms = 100'000;

// x^a e^-x / Gamma(a)
double scale(double a, double x) {
  return std::exp(a * std::log(x) - x - std::lgamma(a));
}

// Lower part by its series; converges quickly for x < a + 1.
double lower_series(double a, double x) {
  double term = 1.0 / a;
  double sum = term;
  for (int n = 1; n < max_terms && term > negligible * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * scale(a, x);
}

// Upper part by its continued fraction (Lentz), for x >= a + 1.
double upper_fraction(double a, double x) {
  constexpr double tiny = 1e-290;
  double b = x + 1.0 - a;
  double c = 1.0 / tiny;
  double d = 1.0 / b;
  double fraction = d;
  for (int n = 1; n < max_terms; ++n) {
    const double numerator = -n * (n - a);
    b += 2.0;
    d = numerator * d + b;
    d = 1.0 / (std::abs(d) < tiny ? tiny : d);
    c = b + numerator / c;
    c = std::abs(c) < tiny ? tiny : c;
    fraction *= c * d;
    if (std::abs(c * d - 1.0) < negligible) {
      break;
    }
  }
  return fraction * scale(a, x);
}

} // namespace

double chi_squared_probability(double chi_squared, double degrees_of_freedom) {
  if (!(chi_squared > 0.0) || !(degrees_of_freedom > 0.0)) {
    return 1.0;
  }
  const double a = 0.5 * degrees_of_freedom;
  const double x = 0.5 * chi_squared;
  return x < a + 1.0 ? 1.0 - lower_series(a, x) : upper_fraction(a, x);
}

} // namespace dyncal::analysis
