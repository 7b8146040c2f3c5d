// Signals with known answers for the tests of sine approximation; reproducible.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

inline constexpr std::int64_t epoch_ns = 1'700'000'000'123'456'789;

struct Signal {
  std::string frequency_hz = "80";
  double amplitude = 1.25;
  double phase_rad = 0.7; // at phase_origin_ns
  double offset = 0.1;
  std::int64_t phase_origin_ns = epoch_ns;

  [[nodiscard]] double at(std::int64_t stamp_ns, const Frequency& f) const {
    return amplitude *
               std::sin(2.0 * std::numbers::pi * f.reduced_turns(stamp_ns - phase_origin_ns) +
                        phase_rad) +
           offset;
  }
};

// Stamps of a free running sensor: about 1 ms apart, +-10 %.
inline std::vector<std::int64_t> uneven_stamps(std::size_t n, std::int64_t interval_ns = 1'000'000,
                                               std::int64_t first_ns = epoch_ns) {
  std::mt19937_64 random(7);
  std::uniform_int_distribution<std::int64_t> shift(-interval_ns / 10, interval_ns / 10);
  std::vector<std::int64_t> stamps(n);
  for (std::size_t i = 0; i < n; ++i) {
    stamps[i] =
        first_ns + static_cast<std::int64_t>(i) * interval_ns + (i == 0 ? 0 : shift(random));
  }
  return stamps;
}

inline std::vector<double> values_of(const Signal& signal,
                                     const std::vector<std::int64_t>& stamps) {
  const Frequency f = *Frequency::parse(signal.frequency_hz);
  std::vector<double> values;
  for (const std::int64_t stamp : stamps) {
    values.push_back(signal.at(stamp, f));
  }
  return values;
}

inline std::vector<double> noisy(std::vector<double> values, double sd, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, sd);
  for (double& y : values) {
    y += noise(random);
  }
  return values;
}

} // namespace dyncal::analysis
