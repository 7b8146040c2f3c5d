#include "analysis/uncertainty/ratio_blocks.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/base/phasor.hpp"
#include "analysis/uncertainty/narrow_band_noise.hpp"

namespace dyncal::analysis {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t min_blocks = min_blocks_of_series;
// A split that leaves most of the scatter beyond noise where it was describes something else: hum
// that beats, a knock.
constexpr double min_explained = 0.4;
// Group delays of a sensor that are tried: what the exciter does, it shows as much later.
constexpr double longest_delay_s = 0.05;
constexpr int delays = 8;
constexpr double likely = 0.01; // of the largest weight
// Offsets that are tried about one that was seen, in its u.
constexpr double seen_reach = 2.5;
constexpr double seen_step = 0.5;
// Seen worse than this part of what the search leaves open, it tells nothing.
constexpr double well_seen = 0.25;

// A split is a change where chance gives it so rarely, and is held by u where it may be one: an
// error of what is not flagged is to be covered.
constexpr double chance_of_flag = 1e-4;
constexpr double chance_of_doubt = 1e-2;
// A level that may be one, in less of the record than this, is not the right one of the two. Chance
// finds most of its splits there: holding a level of two blocks made u of clean steps ten times
// larger.
constexpr double part_of_a_level = 0.25;

// Gain of the best split of n blocks of white noise that chance exceeds: chi-squared with two
// degrees of freedom of n / 4 + 2 splits that are independent. Drawn 10^5 times for 8 to 256
// blocks, those of 10^-4, 21.0 to 27.1, are met within 1.2.
double gain_by_chance(double blocks, double chance) {
  return 2.0 * std::log((0.25 * blocks + 2.0) / chance);
}

// d_k for one offset.
struct Difference {
  std::vector<double> time_s;
  std::vector<Complex> values;
  Complex mean;
  double chi_squared_per_block = 0.0;
  double weight = 0.0;
};

// Into two levels.
struct Split {
  double gain = 0.0;
  double larger_part = 0.0; // of the record
  RatioChange change{};

  // By so much of the change the mean may be off.
  [[nodiscard]] double part_of_change(bool is_certain) const {
    const double smaller_part = 1.0 - larger_part;
    return is_certain || smaller_part >= part_of_a_level ? larger_part : smaller_part;
  }
};

class Comparison {
public:
  Comparison(const BlockSeries& numerator, const BlockSeries& denominator)
      : numerator_(numerator), denominator_(denominator),
        // An instant between two blocks has less noise than a block; that is left aside.
        variance_magnitude_(numerator.variance_magnitude + denominator.variance_magnitude),
        variance_phase_(numerator.variance_phase + denominator.variance_phase) {}

  [[nodiscard]] Difference at(double offset_s) const {
    Difference difference;
    for (std::size_t k = 0; k < numerator_.time_s.size(); ++k) {
      if (const auto value = value_at(denominator_, numerator_.time_s[k] + offset_s)) {
        const Complex d = numerator_.log_ratio[k] - *value;
        const double before = difference.values.empty() ? 0.0 : difference.values.back().imag();
        difference.time_s.push_back(numerator_.time_s[k]);
        difference.values.emplace_back(d.real(), before + wrap_phase(d.imag() - before));
      }
    }
    if (difference.values.size() >= min_blocks) {
      difference.mean = mean_of(difference.values);
      difference.chi_squared_per_block =
          chi_squared(difference.values, difference.mean, variance_magnitude_, variance_phase_) /
          static_cast<double>(difference.values.size());
    }
    return difference;
  }

  // As if the records began together.
  [[nodiscard]] Difference nearest(const BlockAlignment& alignment) const {
    const double turns = alignment.period_s > 0.0 && alignment.reach_s > 0.0
                             ? std::round(alignment.offset_s / alignment.period_s)
                             : 0.0;
    Difference difference = at(alignment.offset_s - turns * alignment.period_s);
    difference.weight = 1.0;
    return difference;
  }

  // All offsets that may be, with their weights; the largest weight of all is 1.
  [[nodiscard]] std::vector<Difference> candidates(const BlockAlignment& alignment) const {
    std::vector<Difference> all =
        tells_offset(alignment) ? about_seen(*alignment.seen) : within_reach(alignment);
    const double margin_s = 0.5 * spacing_s(denominator_);
    weigh(all, denominator_.time_s.front() - margin_s + alignment.reach_s,
          denominator_.time_s.back() + margin_s - alignment.reach_s);
    return all;
  }

  // Not where it lies beyond what the search leaves open: something else was seen.
  [[nodiscard]] static bool tells_offset(const BlockAlignment& alignment) {
    const auto& seen = alignment.seen;
    const double within_s = alignment.reach_s + (seen ? 3.0 * seen->u_s : 0.0);
    return seen && seen->u_s < well_seen * alignment.reach_s && seen->offset_s < within_s &&
           seen->offset_s > -within_s - longest_delay_s;
  }

  [[nodiscard]] std::vector<Difference> about_seen(const SeenOffset& seen) const {
    std::vector<Difference> all;
    for (double z = -seen_reach; z <= seen_reach; z += seen_step) {
      Difference difference = at(seen.offset_s + z * seen.u_s);
      if (difference.values.size() >= min_blocks) {
        difference.weight = std::exp(-0.5 * z * z);
        all.push_back(std::move(difference));
      }
    }
    return all;
  }

  [[nodiscard]] std::vector<Difference> within_reach(const BlockAlignment& alignment) const {
    std::vector<Difference> all;
    const double lowest = std::ceil((-alignment.reach_s - alignment.offset_s) / alignment.period_s);
    const double highest =
        std::floor((alignment.reach_s - alignment.offset_s) / alignment.period_s);
    const double longest_s = std::min(longest_delay_s, alignment.period_s);
    for (double n = lowest; n <= highest; n += 1.0) {
      const double offset_s = alignment.offset_s + n * alignment.period_s;
      for (int part = 0; part < delays; ++part) {
        Difference difference = at(offset_s - longest_s * part / delays);
        if (difference.values.size() >= min_blocks) {
          difference.weight = std::max(1e-3, 1.0 - std::abs(offset_s) / alignment.reach_s);
          all.push_back(std::move(difference));
        }
      }
    }
    return all;
  }

  // Of the mean, where noise is more than white, or the ratio may have changed.
  void add_scatter(const Difference& difference, RatioInBlocks& result) const {
    const MeanFactor factor =
        factor_of_narrow_band_noise(difference.values, variance_magnitude_, variance_phase_);
    const Split split = best_split(difference);
    const bool changed = stands_out(split, difference, chance_of_doubt);
    const double part = split.part_of_change(stands_out(split, difference, chance_of_flag));
    // Of a level, which is known as well as the mean.
    const auto u_of = [&](double times, double variance, double change) {
      const double white = std::sqrt(variance);
      const double of_level = changed ? white + 0.5 * part * std::abs(change) : 0.0;
      return std::max(times > 1.0 ? times * white : 0.0, of_level);
    };
    result.u_magnitude_rel =
        u_of(factor.magnitude,
             of_records(numerator_.variance_magnitude, denominator_.variance_magnitude),
             split.change.magnitude_rel);
    result.u_phase_rad =
        u_of(factor.phase, of_records(numerator_.variance_phase, denominator_.variance_phase),
             split.change.phase_rad);
  }

  [[nodiscard]] std::optional<RatioChange> change_in(const Difference& difference) const {
    const Split split = best_split(difference);
    return stands_out(split, difference, chance_of_flag) ? std::optional(split.change)
                                                         : std::nullopt;
  }

private:
  [[nodiscard]] Split best_split(const Difference& difference) const {
    const std::size_t m = difference.values.size();
    Split best;
    Complex before;
    for (std::size_t j = 1; j + 1 < m; ++j) {
      before += difference.values[j - 1] - difference.mean;
      if (j < 2) {
        continue; // one block alone is a knock
      }
      const double n = static_cast<double>(j), rest = static_cast<double>(m - j);
      const Complex step = -before * (1.0 / n + 1.0 / rest);
      const double weight = n * rest / (n + rest);
      const double gain = weight * (step.real() * step.real() / variance_magnitude_ +
                                    step.imag() * step.imag() / variance_phase_);
      if (gain > best.gain) {
        const double at_s = 0.5 * (difference.time_s[j - 1] + difference.time_s[j]);
        best = {gain, std::max(n, rest) / (n + rest), {at_s, step.real(), step.imag()}};
      }
    }
    return best;
  }

  // Against noise as white as stated or as large as what the split leaves.
  [[nodiscard]] static bool stands_out(const Split& split, const Difference& difference,
                                       double chance) {
    const double m = static_cast<double>(difference.values.size());
    const double total = difference.chi_squared_per_block * m;
    const double freedom = 2.0 * m - 4.0;
    const double noise = std::max(1.0, (total - split.gain) / freedom);
    const double beyond_noise = total - (freedom + 2.0);
    return difference.values.size() >= 2 * min_blocks &&
           split.gain > gain_by_chance(m, chance) * noise &&
           split.gain > min_explained * beyond_noise;
  }

  // What white noise gives the ratio of the whole records: noise stays the same along them,
  // whatever part of them both have.
  [[nodiscard]] double of_records(double numerator, double denominator) const {
    return numerator / static_cast<double>(numerator_.time_s.size()) +
           denominator / static_cast<double>(denominator_.time_s.size());
  }

  // By the blocks that all candidates have: what others have says nothing of the offset.
  void weigh(std::vector<Difference>& all, double first_s, double last_s) const {
    constexpr double chance = 3.0; // standard deviations of what the denominator's noise does
    std::vector<double> sums;
    double blocks = 0.0;
    for (const Difference& one : all) {
      std::vector<Complex> values;
      for (std::size_t k = 0; k < one.values.size(); ++k) {
        if (one.time_s[k] >= first_s && one.time_s[k] <= last_s) {
          values.push_back(one.values[k]);
        }
      }
      blocks = static_cast<double>(values.size());
      sums.push_back(values.empty() ? 0.0
                                    : chi_squared(values, mean_of(values), variance_magnitude_,
                                                  variance_phase_));
    }
    if (all.empty()) {
      return;
    }
    const double least = *std::min_element(sums.begin(), sums.end());
    // Noise that is larger than white makes the likelihood flatter.
    const double scale = std::max(1.0, 0.5 * least / std::max(1.0, blocks));
    const double share = std::max(denominator_.variance_magnitude / variance_magnitude_,
                                  denominator_.variance_phase / variance_phase_);
    // Between two blocks the denominator has up to half the noise of a block; and its noise, which
    // every candidate has at other places, is multiplied with the numerator's.
    const double margin = share * blocks + chance * 4.0 * std::sqrt(share * blocks);
    double largest = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].weight *= std::exp(-0.5 * std::max(0.0, (sums[i] - least) / scale - margin));
      largest = std::max(largest, all[i].weight);
    }
    for (Difference& one : all) {
      one.weight /= largest;
    }
  }

  const BlockSeries& numerator_;
  const BlockSeries& denominator_;
  double variance_magnitude_, variance_phase_;
};

void add_correction(const std::vector<Difference>& all, double shortening, RatioInBlocks& result) {
  double weights = 0.0;
  Complex mean;
  for (const Difference& one : all) {
    weights += one.weight;
    mean += one.weight * one.mean;
  }
  mean /= weights;
  double magnitude = 0.0, phase = 0.0;
  for (const Difference& one : all) {
    magnitude += one.weight / weights * std::pow(one.mean.real() - mean.real(), 2);
    phase += one.weight / weights * std::pow(one.mean.imag() - mean.imag(), 2);
  }
  result.correction = {mean.real() + shortening, wrap_phase(mean.imag())};
  result.u_correction_magnitude_rel = std::hypot(std::sqrt(magnitude), 0.5 * shortening);
  result.u_correction_phase_rad = std::sqrt(phase);
}

} // namespace

std::optional<RatioInBlocks> compare_in_blocks(BlockSeries numerator, BlockSeries denominator,
                                               const BlockAlignment& alignment) {
  if (numerator.time_s.size() < min_blocks || denominator.time_s.size() < min_blocks) {
    return std::nullopt;
  }
  make_alike(numerator, denominator);
  if (numerator.time_s.size() < min_blocks || denominator.time_s.size() < min_blocks) {
    return std::nullopt;
  }
  const Comparison comparison(numerator, denominator);
  std::vector<Difference> all{comparison.nearest(alignment)};
  // A step shows before the scatter does, which it is only a part of.
  const bool wanders = numerator.varies || denominator.varies || varies(numerator) ||
                       varies(denominator) || comparison.change_in(all.front());
  if (wanders && alignment.reach_s > 0.0) {
    if (std::vector<Difference> likely_ones = comparison.candidates(alignment);
        !likely_ones.empty()) {
      all = std::move(likely_ones);
    }
  }
  const auto best = std::max_element(
      all.begin(), all.end(), [](const auto& a, const auto& b) { return a.weight < b.weight; });
  if (best->values.size() < min_blocks) {
    return std::nullopt;
  }
  RatioInBlocks result;
  comparison.add_scatter(*best, result);
  if (wanders) {
    add_correction(all, numerator.shortening - denominator.shortening, result);
    result.change = comparison.change_in(*best);
    const bool by_offset = std::any_of(all.begin(), all.end(), [&](const Difference& one) {
      return one.weight > likely && !comparison.change_in(one);
    });
    if (by_offset) { // nothing has changed there
      result.change.reset();
    }
  }
  return result;
}

} // namespace dyncal::analysis
