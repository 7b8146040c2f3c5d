// Signals of a quadrature interferometer whose truth is known, for tests: a sine of acceleration
// beside drift and a random walk of the table, noise, and the steps of a converter.
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "analysis/interferometer/ellipse.hpp"

namespace dyncal::analysis::simulated {

inline constexpr double wavelength_m = 632.8e-9;

struct Motion {
  double frequency_hz = 160.0;
  double acceleration_m_s2 = 10.0;
  double displacement_phase_rad = 0.4;
  double sample_rate_hz = 1e6;
  double seconds = 0.1;
  double drift_m_s = 1e-7;
  double table_acceleration_m_s2 = 0.0; // white, standard deviation of one sample
  double start_turns = 0.05;
};

struct Detectors {
  Ellipse ellipse{197.0, -197.0, 1.05, 5.0 * std::numbers::pi / 180.0, 6550.0};
  double noise_rel = 2e-3; // of the radius, both signals
};

struct Signals {
  std::vector<std::int16_t> u1;
  std::vector<std::int16_t> u2;
  std::vector<double> sync;
};

inline double phase_turns(const Motion& motion, double t, double table_m) {
  const double w = 2.0 * std::numbers::pi * motion.frequency_hz;
  const double s =
      motion.acceleration_m_s2 / (w * w) * std::sin(w * t + motion.displacement_phase_rad) +
      motion.drift_m_s * t + table_m;
  return 2.0 * s / wavelength_m + motion.start_turns;
}

inline constexpr double sync_phase_rad = 0.9;

// About the first sample.
inline std::complex<double> true_acceleration(const Motion& motion) {
  return std::polar(motion.acceleration_m_s2, motion.displacement_phase_rad + std::numbers::pi);
}

inline Signals simulate(const Motion& motion, const Detectors& detectors, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto n = static_cast<std::size_t>(std::llround(motion.sample_rate_hz * motion.seconds));
  const Ellipse& e = detectors.ellipse;
  double table_m = 0.0;
  double table_m_s = 0.0;
  Signals signals;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / motion.sample_rate_hz;
    if (motion.table_acceleration_m_s2 > 0.0) {
      table_m_s += motion.table_acceleration_m_s2 * normal(random) / motion.sample_rate_hz;
      table_m += table_m_s / motion.sample_rate_hz;
    }
    const double phi = 2.0 * std::numbers::pi * phase_turns(motion, t, table_m);
    const double noise = detectors.noise_rel * e.radius;
    const auto counts = [](double value) { return static_cast<std::int16_t>(std::lround(value)); };
    signals.u1.push_back(counts(e.p + e.radius * std::cos(phi) + noise * normal(random)));
    signals.u2.push_back(
        counts(e.q + e.radius / e.r * std::sin(phi - e.alpha_rad) + noise * normal(random)));
    signals.sync.push_back(
        std::sin(2.0 * std::numbers::pi * motion.frequency_hz * t + sync_phase_rad) +
        1e-4 * normal(random));
  }
  return signals;
}

} // namespace dyncal::analysis::simulated
