// Pulses as a channel records them, for tests: steps of a pulse-per-second output behind a filter
// of known delay.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

namespace dyncal::analysis {

// What a filter makes of a step of 1 at 0, over time in samples.
using StepResponse = std::function<double(double)>;

// The integral of a Hann-windowed sinc of 12 samples on either side, its pass band 0.45 of the rate
// wide: what converters have, without their delay.
inline StepResponse linear_phase_filter() {
  constexpr double reach = 12.0;
  constexpr int per_sample = 64;
  constexpr double cut = 0.45;
  const auto size = static_cast<std::size_t>(2.0 * reach * per_sample);
  std::vector<double> sums(size + 1, 0.0);
  for (std::size_t i = 0; i < size; ++i) {
    const double t = (static_cast<double>(i) + 0.5) / per_sample - reach;
    const double x = 2.0 * std::numbers::pi * cut * t;
    const double window = 0.5 + 0.5 * std::cos(std::numbers::pi * t / reach);
    sums[i + 1] = sums[i] + window * std::sin(x) / x;
  }
  return [sums](double t) {
    const double place = (t + reach) * per_sample;
    if (place <= 0.0) {
      return 0.0;
    }
    if (place >= static_cast<double>(sums.size() - 1)) {
      return 1.0;
    }
    const auto i = static_cast<std::size_t>(place);
    const double part = place - static_cast<double>(i);
    return (sums[i] * (1.0 - part) + sums[i + 1] * part) / sums.back();
  };
}

// Of first order: it delays slow signals by `tau` samples.
inline StepResponse one_pole(double tau) {
  return [tau](double t) { return t <= 0.0 ? 0.0 : 1.0 - std::exp(-t / tau); };
}

inline StepResponse no_filter() {
  return [](double t) { return t < 0.0 ? 0.0 : 1.0; };
}

struct DrawnPulses {
  double samples_per_second = 20000.0;
  double first = 7000.3; // place of the first edge
  double width_s = 0.1;
  double low_v = 0.1, high_v = 3.3;
  double noise_v = 0.0;
  StepResponse response = linear_phase_filter();
  std::uint64_t seed = 1;

  [[nodiscard]] double place_of(std::size_t pulse) const {
    return first + samples_per_second * static_cast<double>(pulse);
  }
  [[nodiscard]] std::vector<double> samples(std::size_t count) const {
    std::mt19937_64 generator(seed);
    std::normal_distribution<double> noise(0.0, 1.0);
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double at = static_cast<double>(i);
      const double turn = std::floor((at - first) / samples_per_second + 0.5);
      const double after = at - first - turn * samples_per_second;
      const double pulse = response(after) - response(after - width_s * samples_per_second);
      values[i] = low_v + (high_v - low_v) * pulse;
      if (noise_v > 0.0) {
        values[i] += noise_v * noise(generator);
      }
    }
    return values;
  }
};

} // namespace dyncal::analysis
