#include "analysis/method/series_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/base/statistics.hpp"
#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr double usual_blocks = 8.0;
constexpr double least_u = 1e-9; // of a series without noise: arithmetic leaves less
constexpr std::size_t least_blocks = 4;
constexpr std::size_t least_samples = 8;         // of a block
constexpr double rare = 3.719;                   // normal quantile of 1e-4
constexpr double rare_in_one_of_many = 4.5;      // of 3e-6, for there are many shots
constexpr double noticed = 2.0;                  // standard uncertainties of a bend
constexpr std::size_t differences_to_judge = 20; // as few tell no scale
constexpr double square_of_difference = 6.0;     // 1 + 4 + 1

// Deviations of the blocks, shot by shot.
struct Blocks {
  std::size_t shots = 0, blocks = 0;
  std::vector<double> phase, magnitude;
  std::vector<double> time; // of a block: -1 at the first sample, 1 at the last
  double u = 0.0;           // of one deviation

  [[nodiscard]] const double* of_shot(const std::vector<double>& values, std::size_t shot) const {
    return values.data() + shot * blocks;
  }
};

// First sample of every block, and behind the last.
std::vector<std::size_t> block_borders(const Frequency& frequency,
                                       std::span<const std::int64_t> stamps_ns) {
  const double samples = static_cast<double>(stamps_ns.size());
  const double interval_ns = static_cast<double>(stamps_ns.back()) / (samples - 1.0);
  const double period = 1e9 / frequency.hz() / interval_ns; // in samples
  const double periods = std::floor(samples / period + 1e-6);
  const double of_block = std::max(1.0, std::floor(periods / usual_blocks));
  const auto blocks = static_cast<std::size_t>(std::floor(periods / of_block));
  std::vector<std::size_t> borders;
  for (std::size_t k = 0; k <= blocks; ++k) {
    borders.push_back(std::min(stamps_ns.size(), static_cast<std::size_t>(std::llround(
                                                     static_cast<double>(k) * of_block * period))));
  }
  return borders;
}

struct Projection {
  double phase = 0.0, magnitude = 0.0; // times the amplitude
  double squares = 0.0;                // of what is left
};

// Of the residuals of one block. `sine` and `cosine` are of the frequency.
Projection project(const SineFit& fit, std::span<const double> values, const double* sine,
                   const double* cosine) {
  const double amplitude = fit.amplitude();
  double e = 0.0, ee = 0.0, along = 0.0, across = 0.0, e_along = 0.0, e_across = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double carrier = fit.sine * sine[i] + fit.cosine * cosine[i];
    const double residual = values[i] - carrier - fit.offset;
    const double in_phase = carrier / amplitude;
    const double quadrature = (fit.sine * cosine[i] - fit.cosine * sine[i]) / amplitude;
    e += residual;
    ee += residual * residual;
    along += in_phase;
    across += quadrature;
    e_along += residual * in_phase;
    e_across += residual * quadrature;
  }
  const double n = static_cast<double>(values.size());
  Projection result;
  result.magnitude = 2.0 / n * (e_along - e / n * along);
  result.phase = 2.0 / n * (e_across - e / n * across);
  result.squares =
      ee - e * e / n - 0.5 * n * (std::pow(result.magnitude, 2) + std::pow(result.phase, 2));
  return result;
}

// How much more neighbouring blocks scatter than the noise within them says; 1 where they do not.
double excess_of_neighbours(const Blocks& all) {
  std::vector<double> differences;
  for (const std::vector<double>* values : {&all.phase, &all.magnitude}) {
    for (std::size_t j = 0; j < all.shots; ++j) {
      const double* const shot = all.of_shot(*values, j);
      for (std::size_t k = 1; k + 1 < all.blocks; ++k) {
        differences.push_back(std::abs(shot[k - 1] - 2.0 * shot[k] + shot[k + 1]));
      }
    }
  }
  if (differences.size() < differences_to_judge || !(all.u > 0.0)) {
    return 1.0;
  }
  return std::max(1.0, mad_to_sd * upper_median(differences) /
                           (std::sqrt(square_of_difference) * all.u));
}

std::optional<Blocks> make_blocks(const Frequency& frequency,
                                  std::span<const std::int64_t> stamps_ns,
                                  std::span<const std::span<const double>> series,
                                  std::span<const SineFit> fits) {
  if (stamps_ns.size() < least_blocks * least_samples) {
    return std::nullopt;
  }
  const std::vector<std::size_t> borders = block_borders(frequency, stamps_ns);
  Blocks all;
  all.shots = series.size();
  all.blocks = borders.size() - 1;
  if (all.blocks < least_blocks || borders[1] < least_samples) {
    return std::nullopt;
  }
  std::vector<double> sine(stamps_ns.size()), cosine(stamps_ns.size());
  fill_sine_cosine(frequency, 0, stamps_ns, sine.data(), cosine.data());
  const double last = static_cast<double>(stamps_ns.size() - 1);
  for (std::size_t k = 0; k < all.blocks; ++k) {
    all.time.push_back(static_cast<double>(borders[k] + borders[k + 1] - 1) / last - 1.0);
  }
  double squares = 0.0; // relative to the amplitude
  double freedom = 0.0;
  for (std::size_t j = 0; j < all.shots; ++j) {
    const double amplitude = fits[j].amplitude();
    if (!(amplitude > 0.0)) {
      return std::nullopt;
    }
    for (std::size_t k = 0; k < all.blocks; ++k) {
      const std::size_t first = borders[k];
      const std::size_t n = borders[k + 1] - first;
      const Projection of_block =
          project(fits[j], series[j].subspan(first, n), sine.data() + first, cosine.data() + first);
      all.phase.push_back(of_block.phase / amplitude);
      all.magnitude.push_back(of_block.magnitude / amplitude);
      squares += std::max(0.0, of_block.squares) / (amplitude * amplitude);
      freedom += static_cast<double>(n) - 3.0;
    }
  }
  all.u = std::sqrt(squares / freedom * 2.0 / static_cast<double>(borders[1]));
  all.u = std::max(least_u, all.u * excess_of_neighbours(all));
  return all;
}

// Powers of the time, orthogonal to each other on the blocks.
class TimePolynomials {
public:
  explicit TimePolynomials(const std::vector<double>& time) {
    for (std::size_t order = 0; order < orders; ++order) {
      std::vector<double> values;
      values.reserve(time.size());
      for (const double t : time) {
        values.push_back(std::pow(t, static_cast<double>(order)));
      }
      double start = order % 2 == 0 ? 1.0 : -1.0; // at -1, where sample 0 is
      for (std::size_t lower = 0; lower < order; ++lower) {
        const double part = product(values, polynomials_[lower]) / squares_[lower];
        for (std::size_t k = 0; k < values.size(); ++k) {
          values[k] -= part * polynomials_[lower][k];
        }
        start -= part * starts_[lower];
      }
      squares_.push_back(product(values, values));
      starts_.push_back(start);
      polynomials_.push_back(std::move(values));
    }
  }

  static constexpr std::size_t orders = 4; // constant to cubic

  [[nodiscard]] double coefficient(std::size_t order, const double* values) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < polynomials_[order].size(); ++k) {
      sum += polynomials_[order][k] * values[k];
    }
    return sum / squares_[order];
  }
  [[nodiscard]] double u_of_coefficient(std::size_t order, double u) const {
    return u / std::sqrt(squares_[order]);
  }
  [[nodiscard]] double at_start(std::size_t order) const { return starts_[order]; }
  [[nodiscard]] double at(std::size_t order, std::size_t block) const {
    return polynomials_[order][block];
  }

private:
  static double product(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      sum += a[k] * b[k];
    }
    return sum;
  }

  std::vector<std::vector<double>> polynomials_;
  std::vector<double> squares_, starts_;
};

void judge_rates(const Blocks& all, const TimePolynomials& powers,
                 const std::vector<double>& slopes, double mean_slope, SeriesAgreement& result) {
  const double u = powers.u_of_coefficient(1, all.u);
  double chi_squared = 0.0;
  for (const double slope : slopes) {
    chi_squared += std::pow((slope - mean_slope) / u, 2);
  }
  const double freedom = static_cast<double>(all.shots) - 1.0;
  result.rates_differ = freedom > 0.0 && chi_squared > freedom * chi_squared_limit(freedom, rare);
  if (!result.rates_differ) {
    return;
  }
  for (const double slope : slopes) {
    result.turn_rad.push_back(slope * powers.at_start(1));
  }
  result.u_turn_rad = std::abs(powers.at_start(1)) * u;
  // The common frequency need not be the mean of rates that differ. In rad a half record, as yet.
  const double scatter = u * std::sqrt(chi_squared / freedom);
  result.rate_scatter_rel =
      std::hypot(scatter, mean_slope * std::sqrt(static_cast<double>(all.shots)));
}

// Phases beyond offset and slope of each shot.
void judge_phases(const Blocks& all, const TimePolynomials& powers,
                  const std::vector<double>& slopes, SeriesAgreement& result) {
  double total = 0.0, largest = 0.0;
  for (std::size_t j = 0; j < all.shots; ++j) {
    const double* const shot = all.of_shot(all.phase, j);
    const double offset = powers.coefficient(0, shot);
    double of_shot = 0.0;
    for (std::size_t k = 0; k < all.blocks; ++k) {
      const double left = shot[k] - offset - slopes[j] * powers.at(1, k);
      result.largest_change_rad = std::max(result.largest_change_rad, std::abs(left));
      of_shot += std::pow(left / all.u, 2);
    }
    total += of_shot;
    largest = std::max(largest, of_shot);
  }
  const double freedom = static_cast<double>(all.blocks) - 2.0;
  const double all_freedom = freedom * static_cast<double>(all.shots);
  result.phases_change = total > all_freedom * chi_squared_limit(all_freedom, rare) ||
                         largest > freedom * chi_squared_limit(freedom, rare_in_one_of_many);
}

// The mean over all shots, block by block.
std::vector<double> mean_shot(const Blocks& all, const std::vector<double>& values) {
  std::vector<double> mean(all.blocks, 0.0);
  for (std::size_t j = 0; j < all.shots; ++j) {
    for (std::size_t k = 0; k < all.blocks; ++k) {
      mean[k] += all.of_shot(values, j)[k] / static_cast<double>(all.shots);
    }
  }
  return mean;
}

// What all series have in common.
void judge_mean(const Blocks& all, const TimePolynomials& powers, SeriesAgreement& result) {
  const double u = all.u / std::sqrt(static_cast<double>(all.shots));
  const std::vector<double> phase = mean_shot(all, all.phase);
  const double offset = powers.coefficient(0, phase.data());
  const double slope = powers.coefficient(1, phase.data());
  const std::vector<double> magnitude = mean_shot(all, all.magnitude);
  const double level = mean(magnitude);
  double of_phase = 0.0, of_magnitude = 0.0;
  for (std::size_t k = 0; k < all.blocks; ++k) {
    of_phase += std::pow((phase[k] - offset - slope * powers.at(1, k)) / u, 2);
    of_magnitude += std::pow((magnitude[k] - level) / u, 2);
  }
  const double blocks = static_cast<double>(all.blocks);
  result.phases_change |= of_phase > (blocks - 2.0) * chi_squared_limit(blocks - 2.0, rare);
  result.magnitudes_change = of_magnitude > (blocks - 1.0) * chi_squared_limit(blocks - 1.0, rare);
  double square = 0.0;
  for (std::size_t order = 2; order < TimePolynomials::orders; ++order) {
    const double turn = powers.coefficient(order, phase.data()) * powers.at_start(order);
    const double u_turn = powers.u_of_coefficient(order, u) * std::abs(powers.at_start(order));
    result.bend.turn_rad[order - 2] = turn;
    result.bend.u_rad[order - 2] = u_turn;
    square += std::abs(turn) > noticed * u_turn ? turn * turn - u_turn * u_turn : 0.0;
  }
  result.u_phase_rad = std::sqrt(square);
}

} // namespace

std::optional<SeriesAgreement> compare_series(const Frequency& frequency,
                                              std::span<const std::int64_t> stamps_ns,
                                              std::span<const std::span<const double>> series,
                                              std::span<const SineFit> fits) {
  const auto all = make_blocks(frequency, stamps_ns, series, fits);
  if (!all) {
    return std::nullopt;
  }
  const TimePolynomials powers(all->time);
  std::vector<double> slopes;
  for (std::size_t j = 0; j < all->shots; ++j) {
    slopes.push_back(powers.coefficient(1, all->of_shot(all->phase, j)));
  }
  SeriesAgreement result;
  judge_rates(*all, powers, slopes, mean(slopes), result);
  judge_phases(*all, powers, slopes, result);
  judge_mean(*all, powers, result);
  const double half_record_s = 0.5e-9 * static_cast<double>(stamps_ns.back());
  result.rate_scatter_rel /= frequency.angular() * half_record_s;
  return result;
}

} // namespace dyncal::analysis
