#include "analysis/sine/stamp_scatter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "analysis/base/statistics.hpp"
#include "analysis/sine/alternating_samples.hpp"
#include "analysis/sine/phasor_blocks.hpp"
#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t block_samples = 512;
constexpr std::size_t max_blocks = 16;
constexpr std::size_t min_samples = 64;
constexpr double lost_to_slow = 5.0;   // samples' worth of V that offset, sine and cosine take away
constexpr double certain = 6.0;        // standard uncertainties: 1e-9 of normal noise, whose
                                       // squares have heavier tails
constexpr double smallest = 1e-6;      // of the amplitude: nobody states less
constexpr double open_part = 0.05;     // of the correction: what kind of scatter it is
constexpr double step_part = 0.125;    // of the square of a step
constexpr double heavy_tails = 6.0;    // kurtosis: normal ones that follow the slope have 4.5
constexpr double far_from_rest = 10.0; // robust standard deviations: latencies have hardly any
constexpr std::uint64_t min_far_off = 4;
constexpr double far_off_part = 3e-3; // wherever they are: the sine lacks as large a part of itself
constexpr double left_out = 4.0;      // robust standard deviations
constexpr int refits = 6;
// Of the squares, by cos^2 of the phase: 3/4 for values of other instants, 1/2 for any others.
constexpr double on_slopes = 0.54;
constexpr double at_end = 0.85;       // of the amplitude
constexpr double batched = 0.05;      // of the mean interval
constexpr double min_variance = 0.05; // of cos(2 phi), which is a half where phases are even
// Distortion, folded as it may be, looks like scatter where two of its orders are 2 apart: their
// product turns with 2 phi.
constexpr int highest_distortion = 10;
constexpr double lines_apart = 1.5; // in 1 / T
constexpr int sweeps = 2;           // orders that fold beside each other are not quite orthogonal
constexpr double lost_to_distortion = 2.0 * (highest_distortion - 1); // samples' worth
constexpr double enough_samples = 4.0;                                // times that
// Whole ticks in every interval of some; what they shorten, beside what is seen.
constexpr std::size_t intervals_for_tick = 64;
constexpr double ticks_explain = 0.1;

struct Sample {
  double sine = 0.0; // of the phase of the fitted sine
  double cosine = 0.0;
  double residual = 0.0; // without what is slow
  double whole = 0.0;    // with it, where ticks beat with the samples: these are not far off
};

// Takes an offset and a sine of their own out of the residuals of a block.
void remove_slow(std::span<Sample> block) {
  double n = static_cast<double>(block.size());
  double s = 0.0, c = 0.0, ss = 0.0, sc = 0.0, cc = 0.0, e = 0.0, es = 0.0, ec = 0.0;
  for (const Sample& one : block) {
    s += one.sine;
    c += one.cosine;
    ss += one.sine * one.sine;
    sc += one.sine * one.cosine;
    cc += one.cosine * one.cosine;
    e += one.residual;
    es += one.residual * one.sine;
    ec += one.residual * one.cosine;
  }
  // About the means, two unknowns are left.
  ss -= s * s / n;
  sc -= s * c / n;
  cc -= c * c / n;
  es -= e * s / n;
  ec -= e * c / n;
  const double determinant = ss * cc - sc * sc;
  if (!(determinant > 0.1 * ss * cc)) {
    return;
  }
  const double by_sine = (es * cc - ec * sc) / determinant;
  const double by_cosine = (ec * ss - es * sc) / determinant;
  const double offset = (e - by_sine * s - by_cosine * c) / n;
  for (Sample& one : block) {
    one.residual -= offset + by_sine * one.sine + by_cosine * one.cosine;
  }
}

struct Residuals {
  std::vector<Sample> samples;
  double kept = 1.0; // of V, by what was taken away as slow
};

// As the blocks that the ratio is looked at in (phasor_blocks.hpp), so that what is slower than
// they are is corrected there, and only what is quicker here. 0: none fits.
std::size_t slow_block(const Frequency& frequency, std::span<const std::int64_t> stamps_ns) {
  const double sample_ns = static_cast<double>(stamps_ns.back() - stamps_ns.front()) /
                           static_cast<double>(stamps_ns.size() - 1);
  const auto block = static_cast<std::size_t>(
      std::round(divide_into_blocks(frequency, stamps_ns).block_ns / sample_ns));
  return block <= block_samples ? block : 0;
}

// Evenly spaced blocks of the record, as phases of the fitted sine and residuals.
Residuals residuals_of(const Frequency& frequency, const SineFit& fit, std::int64_t origin_ns,
                       std::span<const std::int64_t> stamps_ns, std::span<const double> values,
                       std::size_t slow) {
  const std::size_t all = (stamps_ns.size() + block_samples - 1) / block_samples;
  const std::size_t stride = (all + max_blocks - 1) / max_blocks;
  const double amplitude = fit.amplitude();
  const double a = fit.sine / amplitude, b = fit.cosine / amplitude;
  std::array<double, block_samples> sine, cosine;
  Residuals residuals;
  std::vector<Sample>& samples = residuals.samples;
  samples.reserve(std::min(stamps_ns.size(), max_blocks * block_samples));
  residuals.kept = slow > 0 ? 1.0 - lost_to_slow / static_cast<double>(slow) : 1.0;
  for (std::size_t k = 0; k < all; k += stride) {
    const std::size_t first = k * block_samples;
    const std::size_t n = std::min(block_samples, stamps_ns.size() - first);
    fill_sine_cosine(frequency, origin_ns, stamps_ns.subspan(first, n), sine.data(), cosine.data());
    const std::size_t before = samples.size();
    for (std::size_t i = 0; i < n; ++i) {
      const double of_phase = a * sine[i] + b * cosine[i];
      const double residual = values[first + i] - fit.offset - amplitude * of_phase;
      samples.push_back({of_phase, a * cosine[i] - b * sine[i], residual, residual});
    }
    if (slow > 0) {
      const std::size_t whole = n / slow * slow;
      samples.resize(before + whole);
      for (std::size_t i = 0; i < whole; i += slow) {
        remove_slow(std::span(samples).subspan(before + i, slow));
      }
    }
  }
  return residuals;
}

double batched_part(std::span<const std::int64_t> stamps_ns) {
  const double mean_ns = static_cast<double>(stamps_ns.back() - stamps_ns.front()) /
                         static_cast<double>(stamps_ns.size() - 1);
  const auto limit_ns = static_cast<std::int64_t>(batched * mean_ns);
  std::size_t count = 0;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    count += stamps_ns[i] - stamps_ns[i - 1] < limit_ns ? 1 : 0;
  }
  return static_cast<double>(count) / static_cast<double>(stamps_ns.size() - 1);
}

std::uint64_t peak_jumps(const std::vector<Sample>& samples, double amplitude) {
  std::uint64_t at_peaks = 0, all = 0;
  for (const Sample& one : samples) {
    if (std::abs(one.whole) > amplitude) {
      ++all;
      at_peaks += std::abs(one.sine) > at_end ? 1 : 0;
    }
  }
  return 10 * at_peaks >= 9 * all ? at_peaks : 0;
}

double robust_sd(const std::vector<Sample>& samples) {
  std::vector<double> sizes;
  sizes.reserve(samples.size());
  for (const Sample& one : samples) {
    sizes.push_back(std::abs(one.whole));
  }
  return mad_to_sd * upper_median(sizes);
}

// Gives the sine back what values far off it took from it: it is fitted again without these.
void fit_to_the_rest(std::vector<Sample>& samples) {
  for (int pass = 0; pass < refits; ++pass) {
    const double limit = left_out * robust_sd(samples);
    double ss = 0.0, sc = 0.0, cc = 0.0, es = 0.0, ec = 0.0;
    for (const Sample& one : samples) {
      if (std::abs(one.whole) <= limit) {
        ss += one.sine * one.sine;
        sc += one.sine * one.cosine;
        cc += one.cosine * one.cosine;
        es += one.whole * one.sine;
        ec += one.whole * one.cosine;
      }
    }
    const double determinant = ss * cc - sc * sc;
    if (!(determinant > 0.1 * ss * cc)) {
      return;
    }
    const double by_sine = (es * cc - ec * sc) / determinant;
    const double by_cosine = (ec * ss - es * sc) / determinant;
    for (Sample& one : samples) {
      one.whole -= by_sine * one.sine + by_cosine * one.cosine;
    }
  }
}

std::uint64_t far_off(std::vector<Sample> samples) {
  fit_to_the_rest(samples);
  const double limit = far_from_rest * robust_sd(samples);
  double steep = 0.0, all = 0.0;
  std::uint64_t count = 0;
  for (const Sample& one : samples) {
    if (std::abs(one.whole) > limit) {
      ++count;
      all += one.whole * one.whole;
      steep += one.whole * one.whole * one.cosine * one.cosine;
    }
  }
  const bool many = static_cast<double>(count) > far_off_part * static_cast<double>(samples.size());
  return count >= min_far_off && (many || steep > on_slopes * all) ? count : 0;
}

// Orders whose folded lines are apart: what two orders differ by at one line, is the scatter
// itself.
std::vector<int> separate_orders(const Frequency& frequency,
                                 std::span<const std::int64_t> stamps_ns) {
  const double duration_s = 1e-9 * static_cast<double>(stamps_ns.back() - stamps_ns.front());
  const double rate_hz = static_cast<double>(stamps_ns.size() - 1) / duration_s;
  std::vector<double> taken{0.0};
  std::vector<int> orders;
  for (int order = 1; order <= highest_distortion; ++order) {
    const double hz = order * frequency.hz();
    const double line_hz = std::abs(hz - rate_hz * std::round(hz / rate_hz));
    const bool apart = std::all_of(taken.begin(), taken.end(), [&](double other_hz) {
      return std::abs(line_hz - other_hz) * duration_s > lines_apart;
    });
    if (apart) {
      taken.push_back(line_hz);
      orders.push_back(order);
    }
  }
  return orders;
}

// Takes a sine of each of these multiples of the frequency, but the first, out of the residuals.
void remove_distortion(const std::vector<int>& orders, Residuals& residuals) {
  std::vector<Sample>& samples = residuals.samples;
  std::vector<Sample> turned(samples); // sine and cosine of a multiple of the phase
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      turned[i] = samples[i];
    }
    for (int order = 2; order <= highest_distortion; ++order) {
      double ss = 0.0, sc = 0.0, cc = 0.0, es = 0.0, ec = 0.0;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        Sample& at = turned[i];
        const double sine = at.sine * samples[i].cosine + at.cosine * samples[i].sine;
        at.cosine = at.cosine * samples[i].cosine - at.sine * samples[i].sine;
        at.sine = sine;
        ss += at.sine * at.sine;
        sc += at.sine * at.cosine;
        cc += at.cosine * at.cosine;
        es += samples[i].residual * at.sine;
        ec += samples[i].residual * at.cosine;
      }
      const double determinant = ss * cc - sc * sc;
      if (!std::binary_search(orders.begin(), orders.end(), order) ||
          !(determinant > 0.1 * ss * cc)) {
        continue;
      }
      const double by_sine = (es * cc - ec * sc) / determinant;
      const double by_cosine = (ec * ss - es * sc) / determinant;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i].residual -= by_sine * turned[i].sine + by_cosine * turned[i].cosine;
      }
    }
  }
  residuals.kept *= 1.0 - lost_to_distortion / static_cast<double>(samples.size());
}

// Whether stamps of whole ticks may take this off the amplitude: (w T)^2 / 24. Where they divide a
// period, what they do is a distortion, too. Intervals that are all alike show no ticks.
bool ticks_shorten(const Frequency& frequency, std::span<const std::int64_t> stamps_ns,
                   double shortening) {
  std::int64_t tick_ns = 0, shortest_ns = stamps_ns[1] - stamps_ns[0], longest_ns = shortest_ns;
  const std::size_t end = std::min(stamps_ns.size(), intervals_for_tick + 1);
  for (std::size_t i = 1; i < end; ++i) {
    const std::int64_t interval_ns = stamps_ns[i] - stamps_ns[i - 1];
    tick_ns = std::gcd(tick_ns, interval_ns);
    shortest_ns = std::min(shortest_ns, interval_ns);
    longest_ns = std::max(longest_ns, interval_ns);
  }
  const double turn = 1e-9 * frequency.angular() * static_cast<double>(tick_ns);
  return longest_ns > shortest_ns && turn * turn / 24.0 > shortening;
}

// Of e^2 against cos(2 phi); no u where phases say nothing.
struct Slope {
  double v = 0.0; // V
  double u = 0.0;
};

Slope slope_of_squares(const Residuals& residuals) {
  const std::vector<Sample>& samples = residuals.samples;
  const double n = static_cast<double>(samples.size());
  double m = 0.0, mm = 0.0, squares = 0.0, products = 0.0;
  for (const Sample& one : samples) {
    const double turned = one.cosine * one.cosine - one.sine * one.sine; // cos(2 phi)
    const double square = one.residual * one.residual;
    m += turned;
    mm += turned * turned;
    squares += square;
    products += square * turned;
  }
  const double mean = m / n, spread = mm - m * mean;
  if (!(squares > 0.0) || spread < min_variance * n) {
    return {};
  }
  const double slope = (products - squares * mean) / spread;
  double about_line = 0.0;
  for (const Sample& one : samples) {
    const double turned = one.cosine * one.cosine - one.sine * one.sine - mean;
    const double rest = one.residual * one.residual - squares / n - slope * turned;
    about_line += turned * turned * rest * rest;
  }
  return {2.0 * slope / residuals.kept, std::sqrt(about_line) / spread / residuals.kept};
}

void take(const Slope& slope, double amplitude, double step, StampScatter& scatter) {
  const double square = amplitude * amplitude;
  const bool too_small = std::abs(slope.v) < step_part * step * step;
  scatter.u_shortening_rel = slope.u / square;
  scatter.shortening_rel =
      too_small ? 0.0 : 1.0 - std::sqrt(std::clamp(1.0 - slope.v / square, 0.0, 2.0));
}

} // namespace

double StampScatter::correction_rel() const {
  const bool is_certain = shortening_rel > certain * u_shortening_rel && shortening_rel > smallest;
  return is_certain && shortening_rel < 1.0 ? shortening_rel : 0.0;
}

double StampScatter::u_correction_rel() const {
  const double correction = correction_rel();
  return correction > 0.0 ? std::hypot(u_shortening_rel, open_part * correction) : 0.0;
}

StampScatter measure_stamp_scatter(const Frequency& frequency, const SineFit& fit,
                                   std::int64_t origin_ns, std::span<const std::int64_t> stamps_ns,
                                   std::span<const double> values, double step, SlowScatter slow) {
  StampScatter scatter;
  if (stamps_ns.size() < min_samples || !(fit.amplitude() > 0.0)) {
    return scatter;
  }
  Residuals residuals =
      residuals_of(frequency, fit, origin_ns, stamps_ns, values,
                   slow == SlowScatter::counts ? 0 : slow_block(frequency, stamps_ns));
  const std::vector<Sample>& samples = residuals.samples;
  const double n = static_cast<double>(samples.size());
  scatter.samples = samples.size();
  scatter.batched_part = batched_part(stamps_ns);
  double second = 0.0, fourth = 0.0;
  for (const Sample& one : samples) {
    const double square = one.whole * one.whole;
    second += square;
    fourth += square * square;
  }
  if (n * fourth > heavy_tails * second * second) {
    scatter.peak_jumps = peak_jumps(samples, fit.amplitude());
    scatter.far_off = far_off(samples);
  }
  if (scatter.far_off == 0) {
    scatter.alternating = alternating_part(frequency, fit, origin_ns, stamps_ns, values);
  }
  take(slope_of_squares(residuals), fit.amplitude(), step, scatter);
  const double shortening = scatter.correction_rel();
  if (shortening > 0.0 && n > enough_samples * lost_to_distortion &&
      !ticks_shorten(frequency, stamps_ns, ticks_explain * shortening)) {
    remove_distortion(separate_orders(frequency, stamps_ns), residuals);
    take(slope_of_squares(residuals), fit.amplitude(), step, scatter);
  }
  return scatter;
}

} // namespace dyncal::analysis
