#include "analysis/uncertainty/frequency_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <numeric>
#include <vector>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/uncertainty/mean_error.hpp"
#include "analysis/uncertainty/noise_memories.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t min_blocks = 4;
constexpr std::size_t max_orders = 17; // of the polynomials, from 0 on
constexpr std::size_t slope = 1;
constexpr std::size_t first_of_phase = 2, first_of_magnitude = 1; // that the fit has not taken
constexpr double larger_quantile = 2.326;  // once in a hundred, for each of four bands
constexpr double smaller_quantile = -3.09; // once in a thousand
constexpr double next_strength = 1.5;
constexpr double weakest = 0.1;     // times the mean of C_n
constexpr double strongest = 30.0;  // times their largest
constexpr double negligible = 1e-9; // weight

constexpr double weight_of_flat = 10.0;

using Powers = std::array<double, max_orders>;
using Polynomials = std::vector<std::vector<double>>; // by order, then by place

// Orthonormal over these times, by the recurrence of Stieltjes.
Polynomials orthonormal_polynomials(std::span<const double> times) {
  Polynomials all;
  const std::size_t orders = std::min(max_orders, times.size());
  std::vector<double> next(times.size(), 1.0);
  while (all.size() < orders) {
    // Twice, so that rounding does not add up.
    for (int round = 0; round < 2; ++round) {
      for (const std::vector<double>& one : all) {
        double sum = 0.0;
        for (std::size_t k = 0; k < times.size(); ++k) {
          sum += one[k] * next[k];
        }
        for (std::size_t k = 0; k < times.size(); ++k) {
          next[k] -= sum * one[k];
        }
      }
    }
    double squares = 0.0;
    for (const double value : next) {
      squares += value * value;
    }
    for (double& value : next) {
      value /= std::sqrt(squares);
    }
    all.push_back(next);
    for (std::size_t k = 0; k < times.size(); ++k) {
      next[k] *= times[k];
    }
  }
  return all;
}

struct Shape {
  double weight = 0.0; // prior, of all shapes together 1
  Powers g{};
};

Powers powers_of(double forgets, double offset) {
  constexpr std::size_t places = 64;
  std::vector<double> times;
  for (std::size_t k = 0; k < places; ++k) {
    times.push_back((static_cast<double>(k) + 0.5) / places - 0.5);
  }
  const Polynomials polynomials = orthonormal_polynomials(times);
  Powers powers{};
  for (std::size_t n = 0; n < max_orders; ++n) {
    for (std::size_t i = 0; i < places; ++i) {
      for (std::size_t k = 0; k < places; ++k) {
        const double apart = std::abs(times[i] - times[k]);
        powers.at(n) += polynomials[n][i] * polynomials[n][k] * std::exp(-forgets * apart) *
                        std::cos(2.0 * std::numbers::pi * offset * apart);
      }
    }
  }
  return powers;
}

std::vector<Shape> make_shapes() {
  std::vector<Shape> all{{weight_of_flat, {}}};
  all.front().g.fill(1.0);
  double weights = weight_of_flat;
  for (const NoiseMemory& memory : noise_memories) {
    for (const double offset : noise_offsets) {
      all.push_back({memory.weight, powers_of(memory.forgets, offset)});
      weights += memory.weight;
    }
  }
  for (Shape& shape : all) {
    shape.weight /= weights;
  }
  return all;
}

const std::vector<Shape>& all_shapes() {
  static const std::vector<Shape> shapes = make_shapes();
  return shapes;
}

// C_n of phase and magnitude. The fit has taken constant and slope of the phase, of the magnitude
// the constant alone.
struct FreePowers {
  std::vector<double> phase, magnitude;
};

std::vector<double> powers_from(std::size_t first, const Polynomials& polynomials,
                                std::span<const double> values, double variance) {
  std::vector<double> powers;
  for (std::size_t n = first; n < polynomials.size(); ++n) {
    const double sum =
        std::inner_product(values.begin(), values.end(), polynomials[n].begin(), 0.0);
    powers.push_back(sum * sum / variance);
  }
  return powers;
}

FreePowers free_powers(std::span<const PhasorBlock> blocks, const SineFit& fit,
                       double noise_variance) {
  const std::complex<double> whole{fit.sine, fit.cosine};
  const double first_s = blocks.front().centre_s;
  const double span_s = blocks.back().centre_s - first_s;
  std::vector<double> times, phases, magnitudes;
  double unit_variance = 0.0;
  for (const PhasorBlock& block : blocks) {
    times.push_back((block.centre_s - first_s) / span_s - 0.5);
    phases.push_back((block.phasor / whole).imag());
    magnitudes.push_back((block.phasor / whole).real());
    unit_variance += block.unit_variance / static_cast<double>(blocks.size());
  }
  const double variance = noise_variance * unit_variance / std::norm(whole);
  const Polynomials polynomials = orthonormal_polynomials(times);
  return {powers_from(first_of_phase, polynomials, phases, variance),
          powers_from(first_of_magnitude, polynomials, magnitudes, variance)};
}

// Whether the first 2, 4, 8 .. are larger than white noise's, or all of them smaller.
bool stand_out(std::span<const double> powers) {
  double sum = 0.0;
  std::size_t band = 2;
  for (std::size_t j = 0; j < powers.size(); ++j) {
    sum += powers[j];
    const double n = static_cast<double>(j + 1);
    if (j + 1 == band || j + 1 == powers.size()) {
      if (sum > n * chi_squared_limit(n, larger_quantile)) {
        return true;
      }
      band *= 2;
    }
  }
  const double n = static_cast<double>(powers.size());
  return sum < n * chi_squared_limit(n, smaller_quantile);
}

// Of noise, and the powers that it is held against.
struct Evidence {
  std::span<const double> powers;
  std::size_t first; // order of the first of them
};

double log_likelihood(const Evidence& of, const Powers& g, double white, double strength) {
  double product = 1.0, sum = 0.0, logs = 0.0;
  for (std::size_t j = 0; j < of.powers.size(); ++j) {
    const double expected = white + strength * g.at(j + of.first);
    product *= expected;
    sum += of.powers[j] / expected;
    if (j % 4 == 3) { // before it overflows
      logs += std::log(product);
      product = 1.0;
    }
  }
  return -0.5 * (logs + std::log(product) + sum);
}

struct Hypothesis {
  double log_weight;
  double variance; // of c_1
};

double largest_log(const std::vector<Hypothesis>& all) {
  double largest = all.front().log_weight;
  for (const Hypothesis& one : all) {
    largest = std::max(largest, one.log_weight);
  }
  return largest;
}

// Logarithm of the sum of all weights.
double log_evidence(const std::vector<Hypothesis>& all) {
  const double largest = largest_log(all);
  double sum = 0.0;
  for (const Hypothesis& one : all) {
    sum += std::exp(one.log_weight - largest);
  }
  return largest + std::log(sum);
}

// One shape of noise, beside white noise of 1 or 0, with all its strengths.
void add_strengths(std::span<const Evidence> all, const Shape& shape, double white,
                   std::vector<Hypothesis>& hypotheses) {
  double peak_of_shape = 0.0, peak = white, sum = 0.0, count = 0.0;
  for (const Evidence& one : all) {
    for (std::size_t j = 0; j < one.powers.size(); ++j) {
      peak_of_shape = std::max(peak_of_shape, shape.g.at(j + one.first));
      peak = std::max(peak, one.powers[j]);
      sum += one.powers[j];
      count += 1.0;
    }
  }
  const double first = weakest * std::max(white, sum / count) / peak_of_shape;
  const double last = strongest * peak / peak_of_shape;
  const double steps = std::ceil(std::log(last / first) / std::log(next_strength));
  const double prior = std::log(0.5 * (1.0 - prior_of_white_noise) * shape.weight / steps);
  for (double strength = first; strength < last; strength *= next_strength) {
    double log_weight = prior;
    for (const Evidence& one : all) {
      log_weight += log_likelihood(one, shape.g, white, strength);
    }
    hypotheses.push_back({log_weight, white + strength * shape.g[slope]});
  }
}

std::vector<Hypothesis> hypotheses_of(std::span<const Evidence> all) {
  double log_white = std::log(prior_of_white_noise);
  for (const Evidence& one : all) {
    log_white += log_likelihood(one, all_shapes().front().g, 1.0, 0.0);
  }
  std::vector<Hypothesis> hypotheses{{log_white, 1.0}};
  for (const Shape& shape : all_shapes()) {
    add_strengths(all, shape, 1.0, hypotheses);
    add_strengths(all, shape, 0.0, hypotheses);
  }
  return hypotheses;
}

// Hypotheses of nearly the same variance are one part.
MeanError mixture(const std::vector<Hypothesis>& all) {
  constexpr double bins_an_octave = 8.0;
  const double log_weights = log_evidence(all);
  std::map<int, MeanError::Part> bins;
  for (const Hypothesis& one : all) {
    if (const double weight = std::exp(one.log_weight - log_weights); weight > negligible) {
      MeanError::Part& bin =
          bins[static_cast<int>(std::floor(bins_an_octave * std::log2(one.variance)))];
      bin.weight += weight;
      bin.variance += (one.variance - bin.variance) * weight / bin.weight;
    }
  }
  MeanError error;
  for (const auto& [place, part] : bins) {
    error.parts.push_back(part);
  }
  return error;
}

} // namespace

double factor_of_frequency_noise(std::span<const PhasorBlock> blocks, const SineFit& fit,
                                 double noise_variance) {
  if (blocks.size() < min_blocks || !(noise_variance > 0.0) || !(fit.amplitude() > 0.0)) {
    return 1.0;
  }
  const FreePowers powers = free_powers(blocks, fit, noise_variance);
  if (!stand_out(powers.phase) && !stand_out(powers.magnitude)) {
    return 1.0;
  }
  const std::array both{Evidence{powers.phase, first_of_phase},
                        Evidence{powers.magnitude, first_of_magnitude}};
  std::vector<Hypothesis> hypotheses = hypotheses_of(both);
  const std::vector<Hypothesis> phase = hypotheses_of(std::span(both).first(1));
  const double apart = std::log((1.0 - prior_of_noise_together) / prior_of_noise_together) +
                       log_evidence(hypotheses_of(std::span(both).last(1)));
  for (const Hypothesis& one : phase) {
    hypotheses.push_back({one.log_weight + apart, one.variance});
  }
  return 0.5 * combine(mixture(hypotheses), 0.0).expanded();
}

} // namespace dyncal::analysis
