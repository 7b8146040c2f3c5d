#include "analysis/sine/alternating_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "analysis/base/statistics.hpp"
#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t max_samples = 8192;
constexpr std::size_t min_samples = 64;
constexpr double smallest = 1e-4;   // of the amplitude: spurs of good interleaved converters
constexpr double certain = 4.5;     // standard uncertainties: 4e-5 of normal noise
constexpr double above_near = 2.0;  // times the lines beside it: a line of another kind leaks there
constexpr double apart = 6.0;       // resolutions, beyond the lines beside it
constexpr double same_line = 1.5;   // resolutions
constexpr double other_line = 0.05; // of the amplitude, that a harmonic or hum may have
constexpr double near_of_noise = 2.5; // u: noise exceeds it in 16 of 100 sets of four lines
constexpr int max_order = 10;
constexpr std::size_t lines = 5; // it, and two to either side
constexpr double mains_hz[] = {50.0, 60.0};

// From 0 on; those of missing samples are left out.
std::vector<double> numbers_of(std::span<const std::int64_t> stamps_ns) {
  std::vector<double> intervals;
  intervals.reserve(stamps_ns.size());
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    intervals.push_back(static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]));
  }
  std::vector<double> any_order = intervals;
  const double period = std::max(1.0, upper_median(any_order));
  std::vector<double> numbers{0.0};
  for (const double interval : intervals) {
    numbers.push_back(numbers.back() + std::max(1.0, std::round(interval / period)));
  }
  return numbers;
}

double distance_of_fold(double hz, double rate_hz) {
  return std::abs(hz - rate_hz * std::round(hz / rate_hz));
}

bool same_as_other(double line_hz, double signal_hz, double rate_hz, double resolution_hz) {
  const double limit = same_line * resolution_hz;
  const auto meets = [&](double hz) {
    return distance_of_fold(line_hz - hz, rate_hz) < limit ||
           distance_of_fold(line_hz + hz, rate_hz) < limit;
  };
  for (int k = 2; k <= max_order; ++k) {
    if (meets(k * signal_hz)) {
      return true;
    }
  }
  for (const double hz : mains_hz) {
    for (double order = 1.0; order * hz < rate_hz; order += 1.0) {
      if (meets(order * hz)) {
        return true;
      }
    }
  }
  return false;
}

} // namespace

AlternatingPart alternating_part(const Frequency& frequency, const SineFit& fit,
                                 std::int64_t origin_ns, std::span<const std::int64_t> stamps_ns,
                                 std::span<const double> values) {
  const std::size_t n = std::min(values.size(), max_samples);
  const double amplitude = fit.amplitude();
  if (n < min_samples || !(amplitude > 0.0)) {
    return {};
  }
  const std::size_t first = (values.size() - n) / 2;
  stamps_ns = stamps_ns.subspan(first, n);
  values = values.subspan(first, n);
  const double duration_s = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  const double resolution_hz = 1.0 / duration_s;
  const std::vector<double> numbers = numbers_of(stamps_ns);
  const double rate_hz = numbers.back() / duration_s;
  const double line_hz = 0.5 * rate_hz - frequency.hz();
  if (distance_of_fold(frequency.hz(), rate_hz) < apart * resolution_hz ||
      distance_of_fold(line_hz - frequency.hz(), rate_hz) < apart * resolution_hz) {
    return {};
  }
  std::vector<double> sine(n), cosine(n);
  fill_sine_cosine(frequency, origin_ns, stamps_ns, sine.data(), cosine.data());
  std::array<Complex, lines> sums{};
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double rest = values[i] - fit.offset - fit.sine * sine[i] - fit.cosine * cosine[i];
    squares += rest * rest;
    const Complex turned =
        (std::fmod(numbers[i], 2.0) != 0.0 ? -rest : rest) * Complex(cosine[i], -sine[i]);
    const Complex turn =
        std::polar(1.0, 4.0 * std::numbers::pi * numbers[i] / (numbers.back() + 1.0));
    const Complex twice = turn * turn;
    sums[0] += turned;
    sums[1] += turned * std::conj(twice);
    sums[2] += turned * std::conj(turn);
    sums[3] += turned * turn;
    sums[4] += turned * twice;
  }
  const double scale = 2.0 / static_cast<double>(n) / amplitude;
  const double part = scale * std::abs(sums[0]);
  double near = 0.0;
  for (std::size_t j = 1; j < sums.size(); ++j) {
    near = std::max(near, scale * std::abs(sums[j]));
  }
  // Without the line itself, which may be all that is left.
  const double others =
      std::max(0.0, squares / static_cast<double>(n) - 0.5 * part * part * amplitude * amplitude);
  const double u = std::sqrt(2.0 * others / static_cast<double>(n)) / amplitude;
  const bool other = same_as_other(line_hz, frequency.hz(), rate_hz, resolution_hz);
  AlternatingPart found;
  if (part > std::max({other ? other_line : smallest, certain * u, above_near * near})) {
    found.certain_rel = part;
  }
  if (!other) {
    const Complex signal(fit.sine, fit.cosine);
    found.gain_rel = scale * (Complex(0.0, 1.0) * std::conj(signal) * sums[0]).real() / amplitude;
    found.u_gain_rel = std::max(u, near / near_of_noise);
  }
  return found;
}

} // namespace dyncal::analysis
