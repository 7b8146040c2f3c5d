#include "analysis/step/signal_integrity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "analysis/base/statistics.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "analysis/sine/sine_values.hpp"
#include "analysis/step/held_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr int max_harmonic = 10;
constexpr std::uint64_t min_equal = 5;     // values at an extreme: fewer are chance
constexpr double model_error = 0.05;       // of the amplitude, of a sine fitted to a clipped one
constexpr std::uint64_t min_stuck_run = 4; // samples
constexpr double fine_resolution = 0.02;   // of the amplitude
constexpr double dithering = 0.7;          // steps of noise that leave no value to a phase
constexpr double worth_modelling = 3.0;    // standard uncertainties of a harmonic
constexpr double beyond_range = 0.05;      // of half the range: noise behind an end stop is less
constexpr double min_beyond_part = 0.01;   // of the values: fewer are bumps

// The model of some samples at a time: the fitted sine and the harmonics that stand out.
class ModelBlock {
public:
  static constexpr std::size_t max_samples = value_block_samples;

  // REQUIRES: at most `max_samples`.
  void fill(const Frequency& frequency, const SineFit& fit, std::span<const HarmonicLine> harmonics,
            std::int64_t middle_ns, std::span<const std::int64_t> stamps_ns) {
    fill_sine_cosine(frequency, middle_ns, stamps_ns, sine_.data(), cosine_.data());
    for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
      fundamental_[i] = fit.offset + fit.sine * sine_[i] + fit.cosine * cosine_[i];
      whole_[i] = fundamental_[i];
    }
    int order = 1;
    std::copy_n(sine_.begin(), stamps_ns.size(), power_sine_.begin());
    std::copy_n(cosine_.begin(), stamps_ns.size(), power_cosine_.begin());
    for (const HarmonicLine& harmonic : harmonics) {
      for (; order < harmonic.order; ++order) {
        for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
          const double s = power_sine_[i];
          power_sine_[i] = s * cosine_[i] + power_cosine_[i] * sine_[i];
          power_cosine_[i] = power_cosine_[i] * cosine_[i] - s * sine_[i];
        }
      }
      for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
        whole_[i] +=
            harmonic.line.fit.sine * power_sine_[i] + harmonic.line.fit.cosine * power_cosine_[i];
      }
    }
  }

  [[nodiscard]] double fundamental(std::size_t i) const { return fundamental_[i]; } // with constant
  [[nodiscard]] double at(std::size_t i) const { return whole_[i]; }

private:
  using Row = std::array<double, max_samples>;
  Row sine_, cosine_, power_sine_, power_cosine_, fundamental_, whole_;
};

// The record, and what is fitted to it.
class Model {
public:
  Model(const Frequency& frequency, const PlainChannel& channel,
        std::span<const std::int64_t> stamps_ns, std::span<const double> values)
      : frequency_(frequency), channel_(channel), stamps_ns_(stamps_ns), values_(values),
        middle_ns_(middle_of_record_ns(stamps_ns)) {
    const double duration_s = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
    const double rate_hz = static_cast<double>(values.size() - 1) / duration_s;
    orders = resolved_harmonics(frequency.hz(), duration_s, rate_hz);
    double squares = channel.fit.rss;
    for (const HarmonicLine& harmonic : channel.harmonics) {
      if (std::find(orders.begin(), orders.end(), harmonic.order) == orders.end()) {
        continue;
      }
      const SineFit& line = harmonic.line.fit;
      harmonics_square += line.sine * line.sine + line.cosine * line.cosine;
      squares -= harmonic.line.gain;
      ++harmonics;
      if (line.amplitude() > worth_modelling * line.u_amplitude()) {
        modelled_.push_back(harmonic);
      }
    }
    const double freedom = static_cast<double>(values.size()) - 3.0 - 2.0 * harmonics;
    residual_sd = std::sqrt(std::max(0.0, squares) / std::max(1.0, freedom));
    low = values.front();
    high = values.front();
    for (const ValueBlock& block : channel.blocks) {
      low = std::min(low, block.low);
      high = std::max(high, block.high);
    }
  }

  [[nodiscard]] const SineFit& fit() const { return channel_.fit; }
  [[nodiscard]] std::span<const double> values() const { return values_; }
  [[nodiscard]] const std::vector<ValueBlock>& blocks() const { return channel_.blocks; }
  // Of block `k` of the values.
  [[nodiscard]] std::span<const double> block_values(std::size_t k) const {
    const std::size_t first = k * value_block_samples;
    return values_.subspan(first, std::min(value_block_samples, values_.size() - first));
  }
  // REQUIRES: at most ModelBlock::max_samples.
  void fill(std::size_t first, std::size_t count, ModelBlock& block) const {
    block.fill(frequency_, channel_.fit, modelled_, middle_ns_, stamps_ns_.subspan(first, count));
  }

  // Standard deviation from second differences of the residuals, which neither drift nor hum nor
  // harmonics enter.
  [[nodiscard]] double neighbour_noise() const {
    if (!neighbour_noise_) {
      neighbour_noise_ = measure_neighbour_noise();
    }
    return *neighbour_noise_;
  }

  double harmonics_square = 0.0;
  int harmonics = 0;
  double residual_sd = 0.0;
  double low = 0.0, high = 0.0; // of the values
  std::vector<int> orders;      // of harmonics that are apart from all else

private:
  [[nodiscard]] double measure_neighbour_noise() const {
    constexpr std::size_t max_places = 4096;
    if (values_.size() < 8) {
      return 0.0;
    }
    const std::size_t places = values_.size() - 2;
    const std::size_t stride = std::max<std::size_t>(1, (places + max_places - 1) / max_places);
    std::vector<double> differences;
    ModelBlock block;
    for (std::size_t i = 0; i < places; i += stride) {
      fill(i, 3, block);
      const auto residual = [&](std::size_t k) { return values_[i + k] - block.at(k); };
      differences.push_back(std::abs(residual(0) - 2.0 * residual(1) + residual(2)));
    }
    return mad_to_sd * upper_median(differences) / std::sqrt(6.0);
  }

  const Frequency& frequency_;
  const PlainChannel& channel_;
  std::span<const std::int64_t> stamps_ns_;
  std::span<const double> values_;
  std::int64_t middle_ns_;
  std::vector<HarmonicLine> modelled_;
  mutable std::optional<double> neighbour_noise_;
};

// Values from `from` to `to`.
std::uint64_t count_between(const Model& model, double from, double to) {
  std::uint64_t count = 0;
  for (std::size_t k = 0; k < model.blocks().size(); ++k) {
    if (model.blocks()[k].high < from || model.blocks()[k].low > to) {
      continue;
    }
    const auto values = model.block_values(k);
    count += static_cast<std::uint64_t>(std::count_if(
        values.begin(), values.end(), [&](double v) { return v >= from && v <= to; }));
  }
  return count;
}

// Values equal to an extreme of the record: how many there are, how many of them while the fitted
// sine is near it (a sensor that is stuck there stays when the sine goes back), how many steps and
// noise explain (where no step is known, how often the other values repeat), and how far the sine
// moves meanwhile.
struct AtExtreme {
  std::uint64_t count = 0;
  std::uint64_t near = 0;
  double explained = 0.0;
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
};

AtExtreme at_extreme(const Model& model, double extreme, double resolution) {
  constexpr double far = 6.0; // where the error function has ended
  AtExtreme found;
  const double noise = model.residual_sd;
  const double half = resolution > 0.0 ? 0.5 * resolution : 1e-12 * std::abs(extreme);
  if (count_between(model, extreme - half, extreme + half) < min_equal) {
    return found;
  }
  if (resolution == 0.0) {
    found.explained = mean_repeats({model.values().begin(), model.values().end()});
  }
  const double outward = extreme > model.fit().offset ? 1.0 : -1.0;
  const double margin =
      2.0 * resolution + 6.0 * model.neighbour_noise() + model_error * model.fit().amplitude();
  const double scale = 1.0 / (std::numbers::sqrt2 * std::max(noise, 0.1 * resolution + 1e-300));
  ModelBlock block;
  for (std::size_t k = 0; k < model.blocks().size(); ++k) {
    const auto values = model.block_values(k);
    model.fill(k * value_block_samples, values.size(), block);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::abs(values[i] - extreme) <= half) {
        const double fundamental = block.fundamental(i);
        ++found.count;
        found.near += outward * (fundamental - extreme) > -margin ? 1 : 0;
        found.lowest = std::min(found.lowest, fundamental);
        found.highest = std::max(found.highest, fundamental);
      }
      const double distance = block.at(i) - extreme;
      if (resolution > 0.0 && (std::abs(distance) - half) * scale < far) {
        found.explained +=
            0.5 * (std::erf((distance + half) * scale) - std::erf((distance - half) * scale));
      }
    }
  }
  return found;
}

bool is_clipped(const AtExtreme& found, const Model& model, double resolution) {
  if (found.count < min_equal) {
    return false;
  }
  const double explained = 1.5 * found.explained + 4.0 * std::sqrt(found.explained) + 2.0;
  if (2 * found.near < found.count || static_cast<double>(found.count) < explained) {
    return false;
  }
  const double noise = model.neighbour_noise();
  const double amplitude = model.fit().amplitude();
  const bool noise_separates = noise > std::max(dithering * resolution, 1e-9 * amplitude);
  return noise_separates ||
         found.highest - found.lowest > 1.2 * resolution + 4.0 * noise + 1e-6 * amplitude;
}

double shortening(double part) {
  const double x = std::numbers::pi * std::min(part, 0.5);
  return x * x * x / (3.0 * std::numbers::pi);
}

// A range that values lie well beyond is not that of the sensor, whoever stated it.
bool lies_beyond(const Model& model, const SignalExpectation& expected) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double margin = beyond_range * 0.5 * (expected.range_high - expected.range_low);
  const double low = expected.range_low - margin, high = expected.range_high + margin;
  const std::uint64_t count = (model.low < low ? count_between(model, -infinity, low) : 0) +
                              (model.high > high ? count_between(model, high, infinity) : 0);
  return static_cast<double>(count) > min_beyond_part * static_cast<double>(model.values().size());
}

// Where steps are fine: a sine of a few steps may well end one step below its range.
double upper_end(const Model& model, const SignalExpectation& expected) {
  const bool is_fine = expected.resolution < fine_resolution * model.fit().amplitude();
  return expected.range_high - (is_fine ? 1.5 : 0.5) * expected.resolution;
}

void measure_limits(const Model& model, const SignalExpectation& expected,
                    SignalIntegrity& integrity) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double n = static_cast<double>(model.values().size());
  const double half = 0.5 * expected.resolution;
  const auto part = [n](std::uint64_t count) { return static_cast<double>(count) / n; };
  const double at_low = part(count_between(model, -infinity, expected.range_low + half));
  const double at_high = part(count_between(model, upper_end(model, expected), infinity));
  integrity.at_range_part = at_low + at_high;
  const auto clipped = [&](double extreme) {
    const AtExtreme found = at_extreme(model, extreme, expected.resolution);
    return is_clipped(found, model, expected.resolution) ? part(found.count) : 0.0;
  };
  const double clipped_low = clipped(model.low);
  const double clipped_high = clipped(model.high);
  integrity.clipped_part = clipped_low + clipped_high;
  integrity.clipping_rel =
      shortening(std::max(at_low, clipped_low)) + shortening(std::max(at_high, clipped_high));
}

// How far the fitted sine, or the whole model, moves during some samples.
double movement(const Model& model, std::size_t first, std::size_t count,
                double (ModelBlock::*at)(std::size_t) const) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  ModelBlock block;
  for (std::size_t i = 0; i < count; i += ModelBlock::max_samples) {
    const std::size_t n = std::min(ModelBlock::max_samples, count - i);
    model.fill(first + i, n, block);
    for (std::size_t k = 0; k < n; ++k) {
      lowest = std::min(lowest, (block.*at)(k));
      highest = std::max(highest, (block.*at)(k));
    }
  }
  return highest - lowest;
}

// Of the run of equal values that begins at `first`.
std::size_t run_length(std::span<const double> values, std::size_t first) {
  std::size_t end = first + 1;
  while (end < values.size() && values[end] == values[first]) {
    ++end;
  }
  return end - first;
}

void measure_runs(const Model& model, const SignalExpectation& expected,
                  SignalIntegrity& integrity) {
  const std::span<const double> values = model.values();
  std::uint64_t stuck = 0;
  for (std::size_t first = 0; first < values.size();) {
    const std::size_t block = first / value_block_samples;
    if (!model.blocks()[block].repeats) { // only its last value may be repeated, in the next block
      first = std::max(first, std::min((block + 1) * value_block_samples, values.size()) - 1);
    }
    const double value = values[first];
    const std::uint64_t length = run_length(values, first);
    integrity.longest_run = std::max(integrity.longest_run, length);
    const bool at_an_end =
        (integrity.clipped_part > 0.0 && (value == model.low || value == model.high)) ||
        value <= expected.range_low || value >= upper_end(model, expected);
    if (length >= min_stuck_run && !at_an_end) {
      const double natural = 2.0 * expected.resolution + 6.0 * model.neighbour_noise() +
                             0.02 * model.fit().amplitude();
      if (movement(model, first, length, &ModelBlock::fundamental) > natural) {
        integrity.longest_stuck = std::max(integrity.longest_stuck, length);
        stuck += length;
      }
    } else if (length > 1 && !at_an_end) {
      const double natural_repeat =
          2.0 * expected.resolution + 8.0 * model.neighbour_noise() + 0.1 * model.fit().amplitude();
      if (movement(model, first, length, &ModelBlock::at) > natural_repeat) {
        integrity.longest_repeat = std::max(integrity.longest_repeat, length);
        ++integrity.repeats;
      }
    }
    first += length;
  }
  integrity.stuck_part = static_cast<double>(stuck) / static_cast<double>(values.size());
}

} // namespace

SignalIntegrity measure_integrity(const Frequency& frequency, const PlainChannel& channel,
                                  std::span<const std::int64_t> stamps_ns,
                                  std::span<const double> values, const SignalExpectation& stated) {
  const Model model(frequency, channel, stamps_ns, values);
  SignalIntegrity integrity;
  integrity.beyond_range = lies_beyond(model, stated);
  const SignalExpectation expected =
      integrity.beyond_range ? SignalExpectation{.resolution = stated.resolution} : stated;
  integrity.samples = values.size();
  integrity.amplitude = model.fit().amplitude();
  integrity.residual_sd = model.residual_sd;
  // Noise alone gives every harmonic the square 4 s^2 / n.
  const double of_noise =
      4.0 * integrity.residual_sd * integrity.residual_sd / static_cast<double>(values.size());
  integrity.thd = std::sqrt(std::max(0.0, model.harmonics_square - of_noise * model.harmonics)) /
                  integrity.amplitude;
  integrity.u_thd =
      std::sqrt(of_noise * std::sqrt(static_cast<double>(model.harmonics))) / integrity.amplitude;
  integrity.noise_sd = std::max(model.neighbour_noise(), expected.resolution / std::sqrt(12.0));
  integrity.shape = sine_shape(frequency, channel, stamps_ns, model.orders, expected.resolution,
                               integrity.residual_sd);
  measure_limits(model, expected, integrity);
  measure_runs(model, expected, integrity);
  const double periods = integrity.shape.periods;
  integrity.repeated_beyond_chance_part = repeated_beyond_chance(
      values, channel.blocks,
      {.amplitude = integrity.amplitude,
       .turn_rad = 2.0 * std::numbers::pi * periods / static_cast<double>(values.size() - 1),
       .noise_sd = model.neighbour_noise(),
       .step = expected.resolution});
  return integrity;
}

Expected<SignalIntegrity> measure_integrity(const Frequency& frequency,
                                            std::span<const std::int64_t> stamps_ns,
                                            std::span<const double> values,
                                            const SignalExpectation& expected) {
  const std::span<const double> channel[] = {values};
  const std::int64_t middle_ns = stamps_ns.empty() ? 0 : middle_of_record_ns(stamps_ns);
  DYNCAL_TRY(const auto fit, fit_sine(frequency, middle_ns, stamps_ns, channel));
  const ResidualSearch search{.first = {frequency, 2, max_harmonic - 1}};
  DYNCAL_TRY(const auto residuals, reduce_residuals(search, stamps_ns, channel, fit));
  return measure_integrity(frequency, plain_channel(fit.front(), search.first, residuals.front()),
                           stamps_ns, values, expected);
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
