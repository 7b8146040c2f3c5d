// Measured responses for tests: a known model with independent errors and errors in common, drawn
// from a seed.
#pragma once

#include <random>
#include <vector>

#include "analysis/response/response_fit.hpp"

namespace dyncal::tests {

inline const std::vector<double> third_octaves{10,   12.5, 16, 20,  25,  31.5, 40,  46.7, 50,
                                               53.3, 63,   80, 100, 125, 160,  200, 250};

// Seed 0: without errors.
inline std::vector<analysis::ResponsePoint>
measured_response(const analysis::ResponseParameters& truth, double u, unsigned seed,
                  const std::vector<double>& frequencies = third_octaves,
                  const analysis::CommonResponseUncertainty& common = {}) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise;
  const auto draw = [&](double size) { return seed == 0 ? 0.0 : size * noise(random); };
  const double gain = draw(common.gain_rel), delay_s = draw(common.delay_s),
               phase_rad = draw(common.phase_rad);
  std::vector<analysis::ResponsePoint> points;
  for (const double f : frequencies) {
    const double angle = phase_rad - 6.283185307179586 * f * delay_s + draw(u);
    points.push_back(
        {f, analysis::response_at(truth, f) * std::exp(std::complex<double>(gain + draw(u), angle)),
         u, u});
  }
  return points;
}

// The low-pass filter of a MEMS sensor.
inline constexpr analysis::ResponseParameters mems_sensor{
    .gain = 1.02, .delay_s = 0.9e-3, .corner_hz = 0.0, .resonance_hz = 320.0, .damping = 0.75};

} // namespace dyncal::tests
