#include "analysis/step/sine_onset.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t min_samples = 8;
constexpr double loudest = 3.0;  // amplitudes: an exciter that overshoots has less
constexpr double of_noise = 6.0; // standard deviations beside it
constexpr double few_lost = 3.0; // intervals, or part of a period
constexpr double part_of_period = 0.25;
constexpr double of_transients_s = 1e-3;
constexpr double of_period = 0.04; // half of what an edge in no time makes of a phase that differs

} // namespace

std::optional<SineOnset> sine_onset(const Frequency& frequency, std::int64_t phase_origin_ns,
                                    const SineFit& fit, const RisingSine& rise,
                                    std::int64_t first_ns) {
  const std::size_t n = rise.stamps_ns.size();
  const double amplitude = fit.amplitude();
  if (n < min_samples || !(amplitude > 0.0)) {
    return std::nullopt;
  }
  std::vector<std::int64_t> stamps_ns(rise.stamps_ns.begin(), rise.stamps_ns.end());
  stamps_ns.push_back(first_ns);
  std::vector<double> sine(n + 1), cosine(n + 1);
  fill_sine_cosine(frequency, phase_origin_ns, stamps_ns, sine.data(), cosine.data());
  const double a = fit.sine / amplitude, b = fit.cosine / amplitude;
  // Trapezia; the record itself begins as its fit says.
  const double limit = loudest + of_noise * fit.residual_sd() / amplitude;
  double before_s = 0.0, squares_s2 = 0.0, longest_s = 0.0, last_s = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double value = (rise.values[i] - fit.offset) / amplitude;
    if (!(std::abs(value) < limit)) {
      return std::nullopt;
    }
    const double next_s = 1e-9 * static_cast<double>(stamps_ns[i + 1] - stamps_ns[i]);
    const double weight_s = 0.5 * (last_s + next_s);
    before_s += 2.0 * weight_s * value * (a * sine[i] + b * cosine[i]);
    squares_s2 += weight_s * weight_s;
    longest_s = std::max(longest_s, next_s);
    last_s = next_s;
  }
  const double period_s = 1.0 / frequency.hz();
  const double mean_s =
      1e-9 * static_cast<double>(first_ns - stamps_ns.front()) / static_cast<double>(n);
  if (longest_s > std::max(few_lost * mean_s, part_of_period * period_s)) {
    return std::nullopt;
  }
  const double of_phase = a * sine[n] + b * cosine[n], across = a * cosine[n] - b * sine[n];
  before_s += last_s * of_phase * of_phase;
  // Of 2 sin^2 the integral is t - sin(2 phi) / 2 w.
  before_s += of_phase * across / frequency.angular();
  const double noise_s = std::sqrt(2.0 * squares_s2) * fit.residual_sd() / amplitude;
  return SineOnset{before_s, std::hypot(std::hypot(noise_s, 0.5 * longest_s),
                                        std::hypot(of_transients_s, of_period * period_s))};
}

} // namespace dyncal::analysis
