#include "analysis/sine/line_products.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "analysis/sine/line_projection.hpp"

namespace dyncal::analysis {
namespace {

constexpr double usable_part = 0.45; // of the mean sample rate

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
    products += std::norm(line_projection(frequency, record.origin_ns(), stamps_ns, rest));
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
  const double others = n - 2.0 * static_cast<double>(found.looked_at);
  const double variance = std::max(0.0, (squares - 0.5 * n * products) / others);
  const double noise = 4.0 * variance / n * static_cast<double>(found.looked_at);
  found.distortion = std::sqrt(std::max(0.0, products - noise) / excited);
  found.u_distortion = std::sqrt(noise / excited);
  found.noise_part = squares > 0.0 ? std::min(1.0, std::sqrt(variance / (squares / n))) : 1.0;
  return found;
}

} // namespace dyncal::analysis
