#include "analysis/sine/schroeder_phases.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {

std::vector<double> schroeder_phases(std::span<const double> amplitudes) {
  const double power =
      std::inner_product(amplitudes.begin(), amplitudes.end(), amplitudes.begin(), 0.0);
  std::vector<double> phases;
  double below = 0.0; // p_1 + ... + p_{k-1}
  double turns = 0.0; // sum of these sums, which is sum (k - j) p_j
  for (const double amplitude : amplitudes) {
    turns += below;
    below += amplitude * amplitude / power;
    phases.push_back(wrap_phase(-2.0 * std::numbers::pi * (turns - std::floor(turns))));
  }
  return phases;
}

std::vector<double> multisine_waveform(std::span<const MultisineLine> lines, double period_s,
                                       std::size_t samples) {
  std::vector<double> waveform(samples, 0.0);
  for (const MultisineLine& line : lines) {
    // Whole turns in a period: the turn of sample i is (k i mod n) / n, exactly.
    const auto turns = static_cast<std::uint64_t>(std::llround(line.frequency_hz * period_s));
    for (std::size_t i = 0; i < samples; ++i) {
      const double part = static_cast<double>(turns * i % samples) / static_cast<double>(samples);
      waveform[i] += line.amplitude * std::sin(2.0 * std::numbers::pi * part + line.phase_rad);
    }
  }
  return waveform;
}

} // namespace dyncal::analysis
