#include "analysis/sine/line_projection.hpp"

#include <algorithm>
#include <array>

#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t values_at_once = 4096;

} // namespace

std::vector<double> without_trend(std::span<const double> values) {
  const double middle = 0.5 * static_cast<double>(values.size() - 1);
  double sum = 0.0;
  double moment = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    sum += values[i];
    moment += x * values[i];
    squares += x * x;
  }
  std::vector<double> rest(values.begin(), values.end());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    rest[i] -= sum / static_cast<double>(rest.size()) +
               moment / squares * (static_cast<double>(i) - middle);
  }
  return rest;
}

std::complex<double> line_projection(const Frequency& frequency, std::int64_t origin_ns,
                                     std::span<const std::int64_t> stamps_ns,
                                     std::span<const double> values) {
  std::array<double, values_at_once> sine;
  std::array<double, values_at_once> cosine;
  std::complex<double> sum;
  for (std::size_t first = 0; first < values.size(); first += values_at_once) {
    const std::size_t n = std::min(values_at_once, values.size() - first);
    fill_sine_cosine(frequency, origin_ns, stamps_ns.subspan(first, n), sine.data(), cosine.data());
    for (std::size_t i = 0; i < n; ++i) {
      sum += std::complex<double>(values[first + i] * sine[i], values[first + i] * cosine[i]);
    }
  }
  return 2.0 / static_cast<double>(values.size()) * sum;
}

} // namespace dyncal::analysis
