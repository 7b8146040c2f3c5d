#include "analysis/uncertainty/narrow_band_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/uncertainty/coverage.hpp"
#include "analysis/uncertainty/noise_memories.hpp"

namespace dyncal::analysis {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t min_values = 4;
constexpr std::size_t max_lines = 16;       // to either side
constexpr double looked_at_quantile = 2.05; // once in 50 for each of five bands
constexpr double next_strength = 3.0;
constexpr double largest_strength = 30.0; // times what the largest line shows
constexpr double strengths = 16.0;        // as many as prior weights are divided by

// g_j of one memory and offset.
struct Shape {
  double weight = 0.0; // prior, of all shapes together 1
  double of_mean = 0.0;
  std::array<double, max_lines> above{}, below{}; // j = 1, 2 ...; j = -1, -2 ...

  [[nodiscard]] double line(std::size_t j) const { return 0.5 * (above[j] + below[j]); }
};

double periodogram(double forgets, double offset, double j) {
  const Complex y{forgets, 2.0 * std::numbers::pi * (j - offset)};
  return 2.0 * (1.0 / y - (1.0 - std::exp(-y)) / (y * y)).real();
}

Shape make_shape(double forgets, double offset) {
  Shape shape;
  shape.of_mean = periodogram(forgets, offset, 0.0);
  for (std::size_t j = 0; j < max_lines; ++j) {
    shape.above.at(j) = periodogram(forgets, offset, static_cast<double>(j + 1));
    shape.below.at(j) = periodogram(forgets, offset, -static_cast<double>(j + 1));
  }
  return shape;
}

// About frequencies above the sine's, at it, and below.
std::vector<Shape> make_shapes() {
  std::vector<Shape> all;
  double weights = 0.0;
  const auto add = [&](const NoiseMemory& memory, double offset) {
    all.push_back(make_shape(memory.forgets, offset));
    all.back().weight = memory.weight;
    weights += memory.weight;
  };
  for (const NoiseMemory& memory : noise_memories) {
    for (const double offset : noise_offsets) {
      add(memory, offset);
      if (offset > 0.0) {
        add(memory, -offset);
      }
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

// Of magnitude and phase together, and of each by itself; white noise gives each line 1.
struct Lines {
  std::vector<double> above, below, magnitude, phase;
};

Lines lines_of(std::span<const Complex> values, double variance_magnitude, double variance_phase) {
  const std::size_t n = values.size();
  const double count = static_cast<double>(n);
  Complex mean;
  std::vector<Complex> turns;
  for (std::size_t k = 0; k < n; ++k) {
    mean += values[k] / count;
    turns.push_back(std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(k) / count));
  }
  const double per_magnitude = 1.0 / std::sqrt(variance_magnitude);
  const double per_phase = 1.0 / std::sqrt(variance_phase);
  std::vector<Complex> scaled;
  for (const Complex& value : values) {
    scaled.emplace_back((value.real() - mean.real()) * per_magnitude,
                        (value.imag() - mean.imag()) * per_phase);
  }
  Lines lines;
  for (std::size_t j = 1; j <= std::min(max_lines, (n - 1) / 2); ++j) {
    Complex in_phase, across; // sums of magnitude and phase with cosine and sine
    for (std::size_t k = 0, turn = 0; k < n; ++k, turn = turn + j < n ? turn + j : turn + j - n) {
      in_phase += scaled[k] * turns[turn].real();
      across += scaled[k] * turns[turn].imag();
    }
    const Complex turned{-across.imag(), across.real()}; // i times it
    lines.above.push_back(std::norm(in_phase - turned) / (2.0 * count));
    lines.below.push_back(std::norm(in_phase + turned) / (2.0 * count));
    lines.magnitude.push_back((in_phase.real() * in_phase.real() + across.real() * across.real()) /
                              count);
    lines.phase.push_back((in_phase.imag() * in_phase.imag() + across.imag() * across.imag()) /
                          count);
  }
  return lines;
}

// Whether the first 1, 2, 4 ... lines are larger than white noise's; else nothing is to be weighed.
bool stand_out(std::span<const double> lines) {
  double sum = 0.0;
  std::size_t band = 1;
  for (std::size_t j = 0; j < lines.size(); ++j) {
    sum += lines[j];
    if (j + 1 == band || j + 1 == lines.size()) {
      const double n = static_cast<double>(j + 1);
      if (sum > n * chi_squared_limit(2.0 * n, looked_at_quantile)) {
        return true;
      }
      band *= 2;
    }
  }
  return false;
}

struct Hypothesis {
  double log_weight;
  double variance; // of the mean, over that of white noise
};

double log_likelihood(std::span<const double> lines, std::span<const double> shape,
                      double strength) {
  double product = 1.0, sum = 0.0, logs = 0.0;
  for (std::size_t j = 0; j < lines.size(); ++j) {
    const double expected = 1.0 + strength * shape[j];
    product *= expected;
    sum += lines[j] / expected;
    if (j % 8 == 7) { // before it overflows
      logs += std::log(product);
      product = 1.0;
    }
  }
  return -logs - std::log(product) - sum;
}

class Hypotheses {
public:
  // Of lines to either side of the mean, independent of each other.
  static Hypotheses together(const Lines& lines) {
    Hypotheses all;
    for (const Shape& shape : all_shapes()) {
      all.add_strengths(shape, shape.above, shape.below, lines.above, lines.below);
    }
    all.add_white(log_likelihood(lines.above, all_shapes().front().above, 0.0) +
                  log_likelihood(lines.below, all_shapes().front().below, 0.0));
    return all;
  }

  // Of a real series.
  static Hypotheses by_itself(std::span<const double> lines) {
    Hypotheses all;
    for (const Shape& shape : all_shapes()) {
      std::array<double, max_lines> of_lines{};
      for (std::size_t j = 0; j < max_lines; ++j) {
        of_lines.at(j) = shape.line(j);
      }
      all.add_strengths(shape, of_lines, {}, lines, {});
    }
    all.add_white(log_likelihood(lines, all_shapes().front().above, 0.0));
    return all;
  }

  // Logarithm of the sum of all weights.
  [[nodiscard]] double log_evidence() const {
    const double largest = largest_log();
    double sum = 0.0;
    for (const Hypothesis& one : all_) {
      sum += std::exp(one.log_weight - largest);
    }
    return largest + std::log(sum);
  }

  void append(const Hypotheses& other, double log_weight) {
    for (const Hypothesis& one : other.all_) {
      all_.push_back({one.log_weight + log_weight, one.variance});
    }
  }

  // Half of what holds 95.45 % of the mixture.
  [[nodiscard]] double half_width() const {
    constexpr double bins_an_octave = 4.0; // of the variance: few normal distributions are enough
    struct Bin {
      double weight = 0.0, variance = 0.0;
    };
    std::map<int, Bin> bins;
    const double largest = largest_log();
    double weights = 0.0, widest = 1.0;
    for (const Hypothesis& one : all_) {
      const double weight = std::exp(one.log_weight - largest);
      if (weight > 1e-9) {
        Bin& bin = bins[static_cast<int>(bins_an_octave * std::log2(one.variance))];
        bin.weight += weight;
        bin.variance += weight * one.variance;
        weights += weight;
        widest = std::max(widest, one.variance);
      }
    }
    double low = 0.0, high = 8.0 * std::sqrt(widest);
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      double held = 0.0;
      for (const auto& [place, bin] : bins) {
        held += bin.weight * std::erf(middle / std::sqrt(2.0 * bin.variance / bin.weight));
      }
      (held < two_sigma_probability * weights ? low : high) = middle;
    }
    return std::max(1.0, 0.25 * (low + high));
  }

private:
  void add_strengths(const Shape& shape, std::span<const double> above,
                     std::span<const double> below, std::span<const double> lines_above,
                     std::span<const double> lines_below) {
    double shape_peak = 0.0, line_peak = 1.0;
    for (std::size_t j = 0; j < lines_above.size(); ++j) {
      shape_peak = std::max(shape_peak, above[j]);
      line_peak = std::max(line_peak, lines_above[j]);
    }
    for (std::size_t j = 0; j < lines_below.size(); ++j) {
      shape_peak = std::max(shape_peak, below[j]);
      line_peak = std::max(line_peak, lines_below[j]);
    }
    const double prior = std::log((1.0 - prior_of_white_noise) * shape.weight / strengths);
    for (double peak = 1.0 / std::sqrt(next_strength); peak < largest_strength * line_peak;
         peak *= next_strength) {
      const double strength = peak / shape_peak;
      all_.push_back({prior + log_likelihood(lines_above, above, strength) +
                          log_likelihood(lines_below, below, strength),
                      1.0 + strength * shape.of_mean});
    }
  }

  void add_white(double log_likelihood) {
    all_.push_back({std::log(prior_of_white_noise) + log_likelihood, 1.0});
  }

  [[nodiscard]] double largest_log() const {
    return std::max_element(
               all_.begin(), all_.end(),
               [](const Hypothesis& a, const Hypothesis& b) { return a.log_weight < b.log_weight; })
        ->log_weight;
  }

  std::vector<Hypothesis> all_;
};

} // namespace

MeanFactor factor_of_narrow_band_noise(std::span<const Complex> values, double variance_magnitude,
                                       double variance_phase) {
  if (values.size() < min_values || !(variance_magnitude > 0.0) || !(variance_phase > 0.0)) {
    return {};
  }
  const Lines lines = lines_of(values, variance_magnitude, variance_phase);
  if (!stand_out(lines.magnitude) && !stand_out(lines.phase)) {
    return {};
  }
  const Hypotheses magnitude = Hypotheses::by_itself(lines.magnitude);
  const Hypotheses phase = Hypotheses::by_itself(lines.phase);
  Hypotheses of_magnitude = Hypotheses::together(lines);
  Hypotheses of_phase = of_magnitude;
  const double apart = std::log((1.0 - prior_of_noise_together) / prior_of_noise_together);
  of_magnitude.append(magnitude, apart + phase.log_evidence());
  of_phase.append(phase, apart + magnitude.log_evidence());
  return {of_magnitude.half_width(), of_phase.half_width()};
}

} // namespace dyncal::analysis
