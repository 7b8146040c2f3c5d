#include "analysis/sine/line_products.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <set>
#include <vector>

#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr double usable_part = 0.45; // of the mean sample rate
constexpr std::size_t values_at_once = 4096;

// As multiples of 1 / period, without the excited ones.
std::set<std::int64_t> products_of(std::span<const Frequency> lines, double period_s,
                                   double highest_hz) {
  std::vector<std::int64_t> excited;
  for (const Frequency& line : lines) {
    excited.push_back(std::llround(line.hz() * period_s));
  }
  std::set<std::int64_t> products;
  for (const std::int64_t a : excited) {
    products.insert(3 * a);
    for (const std::int64_t b : excited) {
      products.insert(a + b);
      products.insert(std::abs(a - b));
    }
  }
  std::erase_if(products, [&](std::int64_t line) {
    return line == 0 || static_cast<double>(line) > highest_hz * period_s ||
           std::ranges::find(excited, line) != excited.end();
  });
  return products;
}

// Without the straight line through them, by sums about the middle.
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

std::complex<double> projection(const Frequency& frequency, std::int64_t origin_ns,
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

} // namespace

LineProducts measure_line_products(std::span<const Frequency> lines, double period_s,
                                   const SeparatedLines& record, std::size_t channel,
                                   std::span<const std::int64_t> stamps_ns) {
  const double duration_s = 1e-9 * static_cast<double>(stamps_ns.back() - stamps_ns.front());
  const auto n = static_cast<double>(stamps_ns.size());
  const std::vector<double> rest = without_trend(record.rest(channel));
  double products = 0.0;
  LineProducts found;
  for (const std::int64_t line :
       products_of(lines, period_s, usable_part * (n - 1.0) / duration_s)) {
    const Frequency frequency = Frequency::from_hz(static_cast<double>(line) / period_s);
    products += std::norm(projection(frequency, record.origin_ns(), stamps_ns, rest));
    ++found.looked_at;
  }
  double squares = 0.0;
  for (const double value : rest) {
    squares += value * value;
  }
  double excited = 0.0;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    excited += std::norm(record.at(line, channel).phasor);
  }
  const double variance = std::max(0.0, squares / n - 0.5 * products);
  const double noise = 4.0 * variance / n * static_cast<double>(found.looked_at);
  found.distortion = std::sqrt(std::max(0.0, products - noise) / excited);
  found.u_distortion = std::sqrt(noise / excited);
  return found;
}

} // namespace dyncal::analysis
