#include "analysis/sine/frequency_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <sstream>
#include <vector>

#include <Eigen/Dense>
#include <unsupported/Eigen/FFT>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t min_samples = 8;
constexpr std::size_t max_grid = std::size_t{1} << 20U;
constexpr std::size_t max_exact_size = 4096; // a transform of any size up to this is quick

// What varies with fewer cycles in the record may as well be a drift.
constexpr std::size_t min_cycles = 4;
// A Hann-windowed sine is down by 40 dB this many bins beside its line.
constexpr std::size_t line_half_width = 4;
constexpr std::size_t surroundings = 32; // bins beside a line that it is compared with
constexpr std::size_t min_beside = 16;   // so few of them tell nothing
// A line over the median beside it. The highest of 10^6 bins of noise is 20 times their median.
constexpr double min_prominence = 40.0;
// Of the slow power, when a cubic is taken out: of a drift little is left, of 1.5 cycles a half.
constexpr double max_left_of_drift = 0.25;

using Spectrum = std::vector<double>; // power by bin

struct Line {
  double bin = 0.0;
  double power = 0.0;
};

Expected<std::int64_t> median_interval_ns(std::span<const std::int64_t> stamps_ns) {
  std::vector<std::int64_t> intervals;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    intervals.push_back(stamps_ns[i] - stamps_ns[i - 1]);
    if (intervals.back() <= 0) {
      return fail(ErrorCode::stamps_not_increasing,
                  "a stamp is not later than the one before it (sample " + std::to_string(i) + ")");
    }
  }
  return upper_median(intervals);
}

// The largest size up to `size` whose only prime factors are 2, 3 and 5: a transform of a large
// prime size takes a time that grows with its square.
std::size_t quick_size(std::size_t size) {
  if (size <= max_exact_size) {
    return size;
  }
  std::size_t best = 0;
  for (std::size_t fives = 1; fives <= size; fives *= 5) {
    for (std::size_t threes = fives; threes <= size; threes *= 3) {
      std::size_t twos = threes;
      while (2 * twos <= size) {
        twos *= 2;
      }
      best = std::max(best, twos);
    }
  }
  return best;
}

// The line between bins: with a Hann window the two largest neighbours are in the ratio (1 + d) /
// (2 - d) of their distance d.
double interpolated_bin(const std::vector<double>& power, std::size_t peak) {
  const double left = std::sqrt(power[peak - 1]);
  const double right = peak + 1 < power.size() ? std::sqrt(power[peak + 1]) : 0.0;
  const double ratio = std::max(left, right) / std::sqrt(power[peak]);
  const double distance = (2.0 * ratio - 1.0) / (ratio + 1.0);
  return static_cast<double>(peak) + (right >= left ? distance : -distance);
}

bool is_constant(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); });
}

std::vector<double> without_mean(std::span<const double> values) {
  double mean = 0.0;
  for (const double value : values) {
    mean += value / static_cast<double>(values.size());
  }
  std::vector<double> deviations(values.size());
  std::transform(values.begin(), values.end(), deviations.begin(),
                 [mean](double value) { return value - mean; });
  return deviations;
}

// Without the cubic that fits best: what a drift is, and a sine of many cycles is not.
std::vector<double> without_drift(std::span<const std::size_t> places,
                                  std::vector<double> deviations) {
  const double middle = 0.5 * static_cast<double>(places.back());
  const auto powers = [&](std::size_t i) {
    const double x = (static_cast<double>(places[i]) - middle) / middle;
    return Eigen::Vector4d(1.0, x, x * x, x * x * x);
  };
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    const Eigen::Vector4d row = powers(i);
    normal += row * row.transpose();
    right += row * deviations[i];
  }
  const Eigen::Vector4d cubic = normal.ldlt().solve(right);
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    deviations[i] -= cubic.dot(powers(i));
  }
  return deviations;
}

double sum_of_squares(const std::vector<double>& values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

// Power of the Hann-windowed spectrum of values times `scale`.
Spectrum spectrum_of(std::span<const std::size_t> places, const std::vector<double>& values,
                     std::size_t size, double scale, Eigen::FFT<double>& transform) {
  std::vector<double> grid(size, 0.0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double window =
        1.0 - std::cos(2.0 * std::numbers::pi * (static_cast<double>(places[i]) + 0.5) /
                       static_cast<double>(size));
    grid[places[i]] = values[i] * window * scale;
  }
  std::vector<std::complex<double>> lines;
  transform.fwd(lines, grid);
  Spectrum power(size / 2 + 1);
  for (std::size_t bin = 0; bin < power.size(); ++bin) {
    power[bin] = std::norm(lines[bin]);
  }
  return power;
}

std::size_t highest(const Spectrum& power, std::size_t from) {
  return static_cast<std::size_t>(
      std::max_element(power.begin() + static_cast<std::ptrdiff_t>(from), power.end()) -
      power.begin());
}

// Whether the power at `peak` stands out of that between `from` and `to` bins beside it. True where
// these are too few to tell.
bool stands_out(const Spectrum& power, std::size_t peak, std::size_t from, std::size_t to) {
  std::vector<double> beside;
  for (std::size_t distance = from; distance <= to; ++distance) {
    if (peak > distance) {
      beside.push_back(power[peak - distance]);
    }
    if (peak + distance < power.size()) {
      beside.push_back(power[peak + distance]);
    }
  }
  if (beside.size() < min_beside) {
    return true;
  }
  return power[peak] >= min_prominence * upper_median(beside);
}

bool is_line(const Spectrum& power, std::size_t peak) {
  return peak >= min_cycles && power[peak] >= power[peak - 1] &&
         stands_out(power, peak, line_half_width, surroundings);
}

// The spectra of all columns, each over its variance.
struct Spectra {
  Spectrum total;           // of all columns together, mean removed
  std::optional<Line> line; // the highest line of a column whose drift was removed
  double slow_power = 0.0;  // below min_cycles, of the column that is highest there
  bool drifts = false;      // it does: little is left of that without a cubic
};

void add_column(std::span<const std::size_t> places, std::span<const double> values,
                std::size_t size, Eigen::FFT<double>& transform, Spectra& spectra) {
  std::vector<double> deviations = without_mean(values.first(places.size()));
  const double squares = sum_of_squares(deviations);
  if (!(squares > 0.0)) {
    return;
  }
  const double scale = 1.0 / std::sqrt(squares);
  const Spectrum power = spectrum_of(places, deviations, size, scale, transform);
  spectra.total.resize(power.size(), 0.0);
  std::transform(power.begin(), power.end(), spectra.total.begin(), spectra.total.begin(),
                 std::plus<>());
  if (power.size() <= 2 * min_cycles) {
    return;
  }
  const Spectrum undrifted =
      spectrum_of(places, without_drift(places, std::move(deviations)), size, scale, transform);
  const auto slow = [](const Spectrum& one) {
    return std::accumulate(one.begin() + 1, one.begin() + min_cycles, 0.0);
  };
  const bool drifts = slow(undrifted) < max_left_of_drift * slow(power);
  const std::size_t peak = highest(undrifted, min_cycles);
  if (is_line(undrifted, peak) && (drifts || highest(undrifted, 1) == peak) &&
      (!spectra.line || undrifted[peak] > spectra.line->power)) {
    spectra.line = Line{interpolated_bin(undrifted, peak), undrifted[peak]};
  }
  if (slow(power) > spectra.slow_power) {
    spectra.slow_power = slow(power);
    spectra.drifts = drifts;
  }
}

std::string hz_text(double hz) {
  std::ostringstream text;
  text.precision(4);
  text << hz;
  return text.str();
}

// The bin of the sine, or why there is none.
Expected<double> choose_bin(const Spectra& spectra, double bin_hz) {
  const Spectrum& power = spectra.total;
  const std::size_t peak = highest(power, 1);
  if (is_line(power, peak)) {
    return interpolated_bin(power, peak);
  }
  if (spectra.line) {
    return spectra.line->bin;
  }
  const bool slow = peak < min_cycles;
  if (slow && spectra.drifts) {
    return fail(ErrorCode::no_excitation,
                "there is no sine to find: the values drift, and beside the drift no frequency "
                "stands out");
  }
  if (!slow && !stands_out(power, peak, line_half_width, power.size())) {
    return fail(ErrorCode::no_excitation, "there is no sine to find: the strongest frequency, " +
                                              hz_text(static_cast<double>(peak) * bin_hz) +
                                              " Hz, does not stand out of the noise");
  }
  return interpolated_bin(power, peak);
}

} // namespace

Expected<Frequency> estimate_frequency(std::span<const std::int64_t> stamps_ns,
                                       std::span<const std::span<const double>> columns,
                                       const Progress& progress) {
  if (stamps_ns.size() < min_samples) {
    return fail(ErrorCode::too_few_samples, "a frequency estimate needs at least eight samples");
  }
  DYNCAL_TRY(const auto interval_ns, median_interval_ns(stamps_ns));
  std::vector<std::size_t> places;
  for (const std::int64_t stamp : stamps_ns) {
    const auto place =
        static_cast<std::size_t>((stamp - stamps_ns.front() + interval_ns / 2) / interval_ns);
    if (place >= max_grid) {
      break;
    }
    places.push_back(place);
  }
  const std::size_t size = quick_size(places.back() + 1);
  places.resize(static_cast<std::size_t>(std::lower_bound(places.begin(), places.end(), size) -
                                         places.begin()));
  Spectra spectra;
  Eigen::FFT<double> transform;
  std::size_t transformed = 0;
  for (const std::span<const double> column : columns) {
    if (column.size() != stamps_ns.size()) {
      return fail(ErrorCode::invalid_argument,
                  "the numbers of stamps and of values of a column differ");
    }
    if (!std::all_of(column.begin(), column.end(),
                     [](double value) { return std::isfinite(value); })) {
      return fail(ErrorCode::not_finite, "a value is not a finite number");
    }
    if (!is_constant(column.first(places.size()))) { // its mean may differ from it by rounding
      add_column(places, column, size, transform, spectra);
    }
    ++transformed;
    if (progress) {
      progress(static_cast<double>(transformed) / static_cast<double>(columns.size()));
    }
  }
  if (spectra.total.empty()) {
    return fail(ErrorCode::no_excitation, "all values are the same: there is no sine to find");
  }
  const double bin_hz = 1e9 / (static_cast<double>(size) * static_cast<double>(interval_ns));
  return choose_bin(spectra, bin_hz).map([&](double bin) {
    return Frequency::from_hz(std::max(bin, 0.5) * bin_hz);
  });
}

} // namespace dyncal::analysis
