// Fits 80 Hz to a second of samples at uneven stamps and prints the amplitude.
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <span>
#include <vector>

#include <dyncal/sine.hpp>

int main() {
  const auto frequency = dyncal::analysis::Frequency::parse("80");
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  for (std::int64_t i = 0; i < 1000; ++i) {
    stamps_ns.push_back(i * 1'000'000 + i * i % 7919);
    values.push_back(2.5 * std::sin(2.0 * std::numbers::pi * 80e-9 * double(stamps_ns.back())));
  }
  const std::vector<std::span<const double>> channels{values};
  const auto fits = dyncal::analysis::fit_sine(*frequency, 0, stamps_ns, channels);
  if (!fits) {
    std::cerr << fits.error().message << '\n';
    return 1;
  }
  std::cout << "amplitude " << fits->front().amplitude() << '\n';
}
