#include "analysis/clock/stamp_beat.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace dyncal::analysis {
namespace {

constexpr std::size_t min_samples = 64;
constexpr double most_off_number = 0.3; // of a period: then an interval tells no number
// |E|^2 n / <e^2> is exponential with mean 1 for errors that scatter freely.
constexpr double significant_power = 11.5; // once in 10^5

double median_interval_ns(std::span<const std::int64_t> stamps_ns) {
  std::vector<double> intervals_ns;
  intervals_ns.reserve(stamps_ns.size());
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    intervals_ns.push_back(static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]));
  }
  const auto middle = intervals_ns.begin() + static_cast<std::ptrdiff_t>(intervals_ns.size() / 2);
  std::nth_element(intervals_ns.begin(), middle, intervals_ns.end());
  return *middle;
}

// From 0; empty where an interval tells none.
std::vector<double> numbers_of(std::span<const std::int64_t> stamps_ns, double period_ns) {
  std::vector<double> numbers{0.0};
  numbers.reserve(stamps_ns.size());
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    const double periods = static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]) / period_ns;
    if (std::abs(periods - std::round(periods)) > most_off_number) {
      return {};
    }
    numbers.push_back(numbers.back() + std::round(periods));
  }
  return numbers;
}

// Distances from the line of least squares.
std::vector<double> errors_ns(std::span<const std::int64_t> stamps_ns,
                              std::span<const double> numbers) {
  const double n = static_cast<double>(numbers.size());
  double mean_number = 0.0, mean_ns = 0.0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    mean_number += numbers[i] / n;
    mean_ns += static_cast<double>(stamps_ns[i] - stamps_ns.front()) / n;
  }
  double squares = 0.0, products = 0.0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double x = numbers[i] - mean_number;
    squares += x * x;
    products += x * (static_cast<double>(stamps_ns[i] - stamps_ns.front()) - mean_ns);
  }
  std::vector<double> errors;
  errors.reserve(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    errors.push_back(static_cast<double>(stamps_ns[i] - stamps_ns.front()) - mean_ns -
                     products / squares * (numbers[i] - mean_number));
  }
  return errors;
}

} // namespace

double stamp_beat_s(const Frequency& frequency, std::span<const std::int64_t> stamps_ns) {
  if (stamps_ns.size() < min_samples) {
    return 0.0;
  }
  const auto numbers = numbers_of(stamps_ns, median_interval_ns(stamps_ns));
  if (numbers.empty()) {
    return 0.0;
  }
  const auto errors = errors_ns(stamps_ns, numbers);
  std::complex<double> sum;
  double squares = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double turns = 2.0 * frequency.reduced_turns(stamps_ns[i] - stamps_ns.front());
    sum += errors[i] * std::polar(1.0, -2.0 * std::numbers::pi * turns);
    squares += errors[i] * errors[i];
  }
  const bool is_real = std::norm(sum) > significant_power * squares;
  return is_real ? 1e-9 * std::abs(sum) / static_cast<double>(errors.size()) : 0.0;
}

} // namespace dyncal::analysis
