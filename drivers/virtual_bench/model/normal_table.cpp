#include "drivers/virtual_bench/model/normal_table.hpp"

#include <cmath>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr int newton_steps = 6;

double probability_below(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

double density(double x) {
  return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
}

} // namespace

NormalTable::NormalTable() {
  double squares = 0.0;
  double x = 0.0; // outwards from the middle, each from its neighbour
  for (std::size_t i = entries / 2; i < entries; ++i) {
    const double wanted = (static_cast<double>(i) + 0.5) / static_cast<double>(entries);
    for (int step = 0; step < newton_steps; ++step) {
      x += (wanted - probability_below(x)) / density(x);
    }
    values_[i] = x;
    values_[entries - 1 - i] = -x;
    squares += 2.0 * x * x;
  }
  const double to_unit = std::sqrt(static_cast<double>(entries) / squares);
  for (double& value : values_) {
    value *= to_unit;
  }
}

} // namespace dyncal::drivers::virtual_bench
