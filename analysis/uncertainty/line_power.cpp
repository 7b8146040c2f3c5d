#include "analysis/uncertainty/line_power.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace dyncal::analysis {
namespace {

constexpr double significant = 4.5; // u: by chance 4 in 100 000
constexpr int grid_points = 97;
constexpr double grid_end = 6.0; // of the least u

// ln I0(x) of the modified Bessel function by its series (DLMF 10.25.2), whose terms are all
// positive; std::cyl_bessel_i takes several times as long. REQUIRES: x at most some hundred.
double log_bessel(double x) {
  constexpr double last_term = 1e-17;
  double term = 1.0, sum = 1.0;
  for (double k = 1.0; term > last_term * sum; ++k) {
    term *= 0.25 * x * x / (k * k);
    sum += term;
  }
  return x < 1e-4 ? 0.25 * x * x : std::log(sum);
}

// ln of the likelihood of h, less what does not depend on it.
double log_likelihood(double h, std::span<const MeasuredAmplitude> measured) {
  double sum = 0.0;
  for (const MeasuredAmplitude& one : measured) {
    const double scaled = h / one.u_component;
    sum += log_bessel(scaled * one.amplitude / one.u_component) - 0.5 * scaled * scaled;
  }
  return sum;
}

} // namespace

double expected_square(std::span<const MeasuredAmplitude> measured) {
  double least_u = std::numeric_limits<double>::infinity();
  for (const MeasuredAmplitude& one : measured) {
    least_u = std::min(least_u, one.u_component);
  }
  if (!(least_u > 0.0 && std::isfinite(least_u))) {
    return 0.0;
  }
  std::array<double, grid_points> logs{};
  const double step = grid_end * least_u / (grid_points - 1);
  for (int i = 0; i < grid_points; ++i) {
    logs.at(static_cast<std::size_t>(i)) = log_likelihood(i * step, measured);
  }
  const double largest = *std::max_element(logs.begin(), logs.end());
  double all = 0.0, of_square = 0.0;
  for (int i = 0; i < grid_points; ++i) {
    const double h = i * step;
    const double weight =
        (i == 0 ? 0.5 : 1.0) * std::exp(logs.at(static_cast<std::size_t>(i)) - largest);
    all += weight;
    of_square += weight * h * h;
  }
  return of_square / all;
}

std::optional<double> square_of_amplitude(std::span<const MeasuredAmplitude> measured) {
  if (measured.empty()) {
    return std::nullopt;
  }
  double seen = 0.0;
  for (const MeasuredAmplitude& one : measured) {
    if (one.amplitude > significant * one.u_component) {
      seen = std::max(seen, one.amplitude * one.amplitude);
    }
  }
  return seen > 0.0 ? seen : expected_square(measured);
}

} // namespace dyncal::analysis
