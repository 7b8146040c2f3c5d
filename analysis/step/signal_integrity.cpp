#include "analysis/step/signal_integrity.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "analysis/base/statistics.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr int max_harmonic = 10;
constexpr double resolved = 1.5;           // distance of lines in 1 / T
constexpr std::uint64_t min_equal = 5;     // values at an extreme: fewer are chance
constexpr double model_error = 0.05;       // of the amplitude, of a sine fitted to a clipped one
constexpr std::uint64_t min_stuck_run = 4; // samples
constexpr double fine_resolution = 0.02;   // of the amplitude

// The record, and what is fitted to it.
struct Model {
  std::span<const double> values;
  SineFit fit;
  std::vector<double> sine, cosine;
  std::vector<double> fundamental; // with the constant
  std::vector<double> residuals;   // of the whole model
  double harmonics_square = 0.0;
  int harmonics = 0;
  double neighbour_noise = 0.0; // standard deviation, from neighbouring residuals

  [[nodiscard]] double at(std::size_t i) const { return values[i] - residuals[i]; }
};

// Orders whose folded frequencies are apart from the signal, the mean, half the rate (where only
// one of sine and cosine is sampled) and each other.
std::vector<int> resolved_harmonics(double frequency_hz, double duration_s, double rate_hz) {
  const auto folded = [rate_hz](double hz) {
    return std::abs(hz - rate_hz * std::round(hz / rate_hz));
  };
  std::vector<double> taken{0.0, folded(frequency_hz)};
  std::vector<int> orders;
  for (int k = 2; k <= max_harmonic; ++k) {
    const double line = folded(k * frequency_hz);
    const bool apart = std::all_of(taken.begin(), taken.end(), [&](double other) {
      return std::abs(line - other) * duration_s > resolved;
    });
    if (apart && (0.5 * rate_hz - line) * duration_s > 0.5 * resolved) {
      taken.push_back(line);
      orders.push_back(k);
    }
  }
  return orders;
}

// Projects the residuals on one harmonic and the constant, and takes the harmonic away.
void take_harmonic(Model& model, int order) {
  const std::size_t n = model.residuals.size();
  std::vector<std::complex<double>> waves(n);
  double s = 0.0, c = 0.0, ss = 0.0, sc = 0.0, cc = 0.0, e = 0.0, es = 0.0, ec = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::complex<double> z(model.cosine[i], model.sine[i]);
    std::complex<double> power = z;
    for (int k = 1; k < order; ++k) {
      power *= z;
    }
    waves[i] = power;
    const double r = model.residuals[i];
    s += power.imag();
    c += power.real();
    ss += power.imag() * power.imag();
    sc += power.imag() * power.real();
    cc += power.real() * power.real();
    e += r;
    es += r * power.imag();
    ec += r * power.real();
  }
  const double count = static_cast<double>(n);
  const double a = ss - s * s / count, b = sc - s * c / count, d = cc - c * c / count;
  const double u = es - s * e / count, v = ec - c * e / count;
  const double determinant = a * d - b * b;
  if (!(determinant > 1e-6 * count * count)) {
    return; // it cannot be told from the constant
  }
  const double in_sine = (d * u - b * v) / determinant;
  const double in_cosine = (a * v - b * u) / determinant;
  for (std::size_t i = 0; i < n; ++i) {
    model.residuals[i] -= in_sine * waves[i].imag() + in_cosine * waves[i].real();
  }
  model.harmonics_square += in_sine * in_sine + in_cosine * in_cosine;
  ++model.harmonics;
}

// From second differences, which neither drift nor hum nor harmonics enter.
double noise_of_neighbours(const std::vector<double>& residuals) {
  if (residuals.size() < 8) {
    return 0.0;
  }
  std::vector<double> differences(residuals.size() - 2);
  for (std::size_t i = 0; i < differences.size(); ++i) {
    differences[i] = std::abs(residuals[i] - 2.0 * residuals[i + 1] + residuals[i + 2]);
  }
  return mad_to_sd * upper_median(differences) / std::sqrt(6.0);
}

Expected<Model> fit_model(const Frequency& frequency, std::span<const std::int64_t> stamps_ns,
                          std::span<const double> values) {
  const std::span<const double> channel[] = {values};
  const std::int64_t origin_ns = stamps_ns.empty() ? 0 : stamps_ns.front();
  auto fit = fit_sine(frequency, origin_ns, stamps_ns, channel);
  if (!fit) {
    return fail(fit.error());
  }
  const std::size_t n = values.size();
  Model model{values,
              fit->front(),
              std::vector<double>(n),
              std::vector<double>(n),
              std::vector<double>(n),
              std::vector<double>(n)};
  fill_sine_cosine(frequency, origin_ns, stamps_ns, model.sine.data(), model.cosine.data());
  for (std::size_t i = 0; i < n; ++i) {
    model.fundamental[i] =
        model.fit.offset + model.fit.sine * model.sine[i] + model.fit.cosine * model.cosine[i];
    model.residuals[i] = values[i] - model.fundamental[i];
  }
  const double duration_s = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  const double rate_hz = static_cast<double>(n - 1) / duration_s;
  for (const int order : resolved_harmonics(frequency.hz(), duration_s, rate_hz)) {
    take_harmonic(model, order);
  }
  model.neighbour_noise = noise_of_neighbours(model.residuals);
  return model;
}

double residual_sd(const Model& model) {
  double squares = 0.0;
  for (const double residual : model.residuals) {
    squares += residual * residual;
  }
  const double freedom = static_cast<double>(model.residuals.size()) - 3.0 - 2.0 * model.harmonics;
  return std::sqrt(squares / std::max(1.0, freedom));
}

// Values equal to an extreme of the record: how many there are, how many of them while the fitted
// sine is near it (a sensor that is stuck there stays when the sine goes back), how many steps and
// noise explain, and how far the sine moves meanwhile.
struct AtExtreme {
  std::uint64_t count = 0;
  std::uint64_t near = 0;
  double explained = 0.0;
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
};

AtExtreme at_extreme(const Model& model, double extreme, double resolution, double noise) {
  AtExtreme found;
  const double outward = extreme > model.fit.offset ? 1.0 : -1.0;
  const double margin =
      2.0 * resolution + 6.0 * model.neighbour_noise + model_error * model.fit.amplitude();
  const double half = resolution > 0.0 ? 0.5 * resolution : 1e-12 * std::abs(extreme);
  const double scale = 1.0 / (std::numbers::sqrt2 * std::max(noise, 0.1 * resolution + 1e-300));
  for (std::size_t i = 0; i < model.values.size(); ++i) {
    if (std::abs(model.values[i] - extreme) <= half) {
      ++found.count;
      found.near += outward * (model.fundamental[i] - extreme) > -margin ? 1 : 0;
      found.lowest = std::min(found.lowest, model.fundamental[i]);
      found.highest = std::max(found.highest, model.fundamental[i]);
    }
    if (resolution > 0.0) {
      const double distance = model.at(i) - extreme;
      found.explained +=
          0.5 * (std::erf((distance + half) * scale) - std::erf((distance - half) * scale));
    }
  }
  return found;
}

bool is_clipped(const AtExtreme& found, const Model& model, double resolution) {
  const double explained = 1.5 * found.explained + 4.0 * std::sqrt(found.explained) + 2.0;
  if (found.count < min_equal || 2 * found.near < found.count ||
      static_cast<double>(found.count) < explained) {
    return false;
  }
  const double noise = model.neighbour_noise;
  const bool noise_separates = noise > std::max(resolution, 1e-9 * model.fit.amplitude());
  return noise_separates || found.highest - found.lowest >
                                1.2 * resolution + 4.0 * noise + 1e-6 * model.fit.amplitude();
}

double shortening(double part) {
  const double x = std::numbers::pi * std::min(part, 0.5);
  return x * x * x / (3.0 * std::numbers::pi);
}

// Where steps are fine: a sine of a few steps may well end one step below its range.
double upper_end(const Model& model, const SignalExpectation& expected) {
  const bool is_fine = expected.resolution < fine_resolution * model.fit.amplitude();
  return expected.range_high - (is_fine ? 1.5 : 0.5) * expected.resolution;
}

// The record's own values `first` .. `end` - 1 are equal: how far the whole model moves meanwhile.
double movement(const Model& model, std::size_t first, std::size_t end) {
  double lowest = model.at(first);
  double highest = lowest;
  for (std::size_t i = first + 1; i < end; ++i) {
    lowest = std::min(lowest, model.at(i));
    highest = std::max(highest, model.at(i));
  }
  return highest - lowest;
}

void measure_limits(const Model& model, const SignalExpectation& expected,
                    SignalIntegrity& integrity) {
  const double n = static_cast<double>(model.values.size());
  const double half = 0.5 * expected.resolution;
  const auto [low, high] = std::minmax_element(model.values.begin(), model.values.end());
  const auto part = [n](auto count) { return static_cast<double>(count) / n; };
  const double at_low = part(std::count_if(model.values.begin(), model.values.end(), [&](double v) {
    return v <= expected.range_low + half;
  }));
  const double at_high =
      part(std::count_if(model.values.begin(), model.values.end(),
                         [&](double v) { return v >= upper_end(model, expected); }));
  integrity.at_range_part = at_low + at_high;
  const double noise = residual_sd(model);
  const auto clipped = [&](double extreme) {
    const AtExtreme found = at_extreme(model, extreme, expected.resolution, noise);
    return is_clipped(found, model, expected.resolution) ? part(found.count) : 0.0;
  };
  const double clipped_low = clipped(*low);
  const double clipped_high = clipped(*high);
  integrity.clipped_part = clipped_low + clipped_high;
  integrity.clipping_rel =
      shortening(std::max(at_low, clipped_low)) + shortening(std::max(at_high, clipped_high));
}

void measure_runs(const Model& model, const SignalExpectation& expected,
                  SignalIntegrity& integrity) {
  const auto [low, high] = std::minmax_element(model.values.begin(), model.values.end());
  const double natural =
      2.0 * expected.resolution + 6.0 * model.neighbour_noise + 0.02 * model.fit.amplitude();
  const double natural_repeat =
      2.0 * expected.resolution + 8.0 * model.neighbour_noise + 0.1 * model.fit.amplitude();
  std::uint64_t stuck = 0;
  for (std::size_t first = 0; first < model.values.size();) {
    const double value = model.values[first];
    double lowest = model.fundamental[first];
    double highest = lowest;
    std::size_t end = first + 1;
    for (; end < model.values.size() && model.values[end] == value; ++end) {
      lowest = std::min(lowest, model.fundamental[end]);
      highest = std::max(highest, model.fundamental[end]);
    }
    const std::uint64_t length = end - first;
    integrity.longest_run = std::max(integrity.longest_run, length);
    const bool at_an_end = (integrity.clipped_part > 0.0 && (value == *low || value == *high)) ||
                           value <= expected.range_low || value >= upper_end(model, expected);
    if (length >= min_stuck_run && highest - lowest > natural && !at_an_end) {
      integrity.longest_stuck = std::max(integrity.longest_stuck, length);
      stuck += length;
    }
    if (length > 1 && length < min_stuck_run && !at_an_end &&
        movement(model, first, end) > natural_repeat) {
      integrity.longest_repeat = std::max(integrity.longest_repeat, length);
      ++integrity.repeats;
    }
    first = end;
  }
  integrity.stuck_part = static_cast<double>(stuck) / static_cast<double>(model.values.size());
}

} // namespace

Expected<SignalIntegrity> measure_integrity(const Frequency& frequency,
                                            std::span<const std::int64_t> stamps_ns,
                                            std::span<const double> values,
                                            const SignalExpectation& expected) {
  const auto model = fit_model(frequency, stamps_ns, values);
  if (!model) {
    return fail(model.error());
  }
  SignalIntegrity integrity;
  integrity.samples = values.size();
  integrity.amplitude = model->fit.amplitude();
  integrity.residual_sd = residual_sd(*model);
  // Noise alone gives every harmonic the square 4 s^2 / n.
  const double of_noise =
      4.0 * integrity.residual_sd * integrity.residual_sd / static_cast<double>(values.size());
  integrity.thd = std::sqrt(std::max(0.0, model->harmonics_square - of_noise * model->harmonics)) /
                  integrity.amplitude;
  integrity.u_thd =
      std::sqrt(of_noise * std::sqrt(static_cast<double>(model->harmonics))) / integrity.amplitude;
  integrity.noise_sd = std::max(model->neighbour_noise, expected.resolution / std::sqrt(12.0));
  measure_limits(*model, expected, integrity);
  measure_runs(*model, expected, integrity);
  return integrity;
}

IntegrityFindings judge_integrity(const SignalIntegrity& integrity,
                                  const IntegrityThresholds& thresholds) {
  IntegrityFindings findings;
  findings.over_range = integrity.at_range_part > thresholds.at_range_part ||
                        integrity.clipped_part > thresholds.clipped_part;
  findings.stuck =
      integrity.longest_stuck >= thresholds.stuck_run || integrity.repeats >= thresholds.repeats;
  findings.distorted =
      integrity.thd > thresholds.thd && integrity.thd > thresholds.thd_in_u * integrity.u_thd;
  findings.refused =
      (findings.over_range && integrity.clipping_rel > thresholds.refused_clipping_rel) ||
      (findings.stuck && integrity.stuck_part > thresholds.refused_stuck_part);
  return findings;
}

} // namespace dyncal::analysis
