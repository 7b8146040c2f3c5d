#include "analysis/sine/frequency_search.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "analysis/sine/sine_solve.hpp"

namespace dyncal::analysis::kernel {
namespace {

using Complex = std::complex<double>;

constexpr double basin_bins = 0.3; // from here the iteration always arrives
constexpr double grid_step_bins = 0.4;
constexpr double min_cycles = 8.0; // below, the image at -f disturbs a Fourier transform
constexpr double min_bins = 4.0;   // below, a grid is cheaper
constexpr std::size_t part_samples = 1024;
constexpr std::size_t padding = 2; // of the transform
constexpr std::size_t groups_a_cell = 2;
constexpr double certain_amplitude = 8.0; // standard uncertainties

Selection part_of(std::size_t samples) {
  constexpr std::size_t group = 32;
  const std::size_t groups = part_samples / group;
  return samples > 2 * part_samples ? Selection{group, samples / groups} : Selection{};
}

Expected<std::vector<Parameters>> levels(const Record& record, const Frequency& frequency,
                                         Selection selection) {
  std::vector<Parameters> start;
  for (const auto& channel : record.channels()) {
    start.push_back({0.0, 0.0, channel.front()});
  }
  DYNCAL_TRY(const auto sums, accumulate(record, frequency, start, selection));
  if (!all_finite(sums)) {
    return fail(record.not_finite());
  }
  for (std::size_t j = 0; j < start.size(); ++j) {
    start[j].offset += sums.channels[j].e / sums.samples;
  }
  return start;
}

struct GridPoint {
  double bins = 0.0;
  double misfit = std::numeric_limits<double>::infinity(); // sum of log rss
  double significance = 0.0; // of the strongest channel: amplitude over its uncertainty
};

GridPoint misfit_of(const PassSums& sums, std::span<const Parameters> start, double bins) {
  GridPoint point;
  point.bins = bins;
  const NormalMatrix matrix(sums.samples, sums.design);
  if (!matrix.well_conditioned()) {
    return point;
  }
  point.misfit = 0.0;
  for (std::size_t j = 0; j < start.size(); ++j) {
    const Solution solution = solve(matrix, sums.channels[j], start[j]);
    const double scale = 1e-30 * solution.ee + std::numeric_limits<double>::min();
    point.misfit += std::log(solution.rss + scale);
    point.significance =
        std::max(point.significance,
                 std::sqrt((solution.ee - solution.rss) / (solution.rss + scale) * sums.samples));
  }
  return point;
}

// The samples of a selection side by side, where every frequency of a grid finds them in the cache.
class Excerpt {
public:
  Excerpt(const Record& record, Selection selection) : values_(record.channels().size()) {
    const auto copy = [&](auto from, auto& to) {
      for (std::size_t i = 0; i < record.size(); i += selection.step) {
        to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(i),
                  from.begin() +
                      static_cast<std::ptrdiff_t>(std::min(i + selection.length, record.size())));
      }
    };
    copy(record.stamps(), stamps_);
    for (std::size_t j = 0; j < values_.size(); ++j) {
      copy(record.channels()[j], values_[j]);
      channels_.emplace_back(values_[j]);
    }
  }
  [[nodiscard]] Expected<Record> record() const { return Record::make(stamps_, channels_, 3); }

private:
  std::vector<std::int64_t> stamps_;
  std::vector<std::vector<double>> values_;
  std::vector<std::span<const double>> channels_;
};

// `bin_hz`: of the whole record.
Expected<GridPoint> search_grid(const Record& record, const Frequency& start,
                                double half_range_bins, double bin_hz) {
  DYNCAL_TRY(const auto level, levels(record, start, {}));
  const int half = static_cast<int>(std::ceil(half_range_bins / grid_step_bins));
  GridPoint best;
  for (int i = -half; i <= half; ++i) {
    const double bins = half_range_bins * i / std::max(half, 1);
    const Frequency frequency = start.shifted_by_hz(bins * bin_hz);
    if (!(frequency.hz() > 0.0)) {
      continue;
    }
    DYNCAL_TRY(const auto sums, accumulate(record, frequency, level));
    const GridPoint point = misfit_of(sums, level, bins);
    if (point.misfit < best.misfit) {
      best = point;
    }
  }
  return best;
}

// In place, length a power of two.
void fourier_transform(std::vector<Complex>& data) {
  const std::size_t n = data.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1;
    for (; j & bit; bit >>= 1) {
      j ^= bit;
    }
    j ^= bit;
    if (i < j) {
      std::swap(data[i], data[j]);
    }
  }
  for (std::size_t length = 2; length <= n; length *= 2) {
    const std::size_t half = length / 2;
    std::vector<Complex> turn(half);
    for (std::size_t k = 0; k < half; ++k) {
      turn[k] = std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k) /
                                    static_cast<double>(length));
    }
    for (std::size_t i = 0; i < n; i += length) {
      for (std::size_t k = 0; k < half; ++k) {
        const Complex a = data[i + k];
        const Complex b = data[i + k + half];
        const Complex turned{b.real() * turn[k].real() - b.imag() * turn[k].imag(),
                             b.real() * turn[k].imag() + b.imag() * turn[k].real()};
        data[i + k] = a + turned;
        data[i + k + half] = a - turned;
      }
    }
  }
}

struct Cells {
  std::vector<std::vector<Complex>> phasors; // a channel; padded
  std::vector<double> square;                // sum of squares a channel
  double samples = 0.0;
};

// Phasors of cells of equal time, from groups short enough that a cell has several.
Expected<Cells> cell_phasors(const Record& record, const Frequency& frequency,
                             std::span<const Parameters> level, std::size_t count, bool whole) {
  const std::size_t n = record.size();
  const std::size_t step = std::clamp<std::size_t>(n / (groups_a_cell * count), 1, block_samples);
  const std::size_t length =
      whole ? step
            : std::clamp<std::size_t>(part_samples / (groups_a_cell * count),
                                      std::min<std::size_t>(step, lanes), step);
  Cells cells;
  cells.phasors.assign(level.size(), std::vector<Complex>(padding * count));
  cells.square.assign(level.size(), 0.0);
  const SineKernel& kernel = best_kernel();
  const TimeAxis axis = record.axis(frequency);
  const std::int64_t* stamps = record.stamps().data();
  BlockBasis basis;
  for (std::size_t i = 0; i < n; i += step) {
    const std::size_t samples = std::min(length, n - i);
    DesignSums design;
    if (!kernel.design(stamps + i, samples, axis, basis, design)) {
      return fail(record.not_increasing());
    }
    const std::int64_t middle_ns = stamps[i] + (stamps[i + samples - 1] - stamps[i]) / 2;
    const double position =
        static_cast<double>(middle_ns - stamps[0]) / (2.0 * record.half_span_ns());
    if (!(position >= 0.0 && position <= 1.0)) {
      return fail(record.not_increasing());
    }
    const std::size_t cell =
        std::min(count - 1, static_cast<std::size_t>(position * static_cast<double>(count)));
    for (std::size_t j = 0; j < level.size(); ++j) {
      ResidualSums sums;
      kernel.residuals(record.channels()[j].data() + i, samples, basis, level[j], sums);
      cells.phasors[j][cell] += Complex(sums.ec, -sums.es);
      cells.square[j] += sums.ee;
    }
    cells.samples += static_cast<double>(samples);
  }
  return cells;
}

Expected<GridPoint> search_spectrum(const Record& record, const Frequency& start,
                                    double half_range_bins, bool whole) {
  DYNCAL_TRY(const auto level, levels(record, start, whole ? Selection{} : part_of(record.size())));
  const std::size_t count = std::bit_ceil(static_cast<std::size_t>(3.0 * half_range_bins));
  DYNCAL_TRY(auto cells, cell_phasors(record, start, level, count, whole));
  const std::size_t length = padding * count;
  std::vector<double> power(length, 0.0);
  for (std::size_t j = 0; j < level.size(); ++j) {
    if (!std::isfinite(cells.square[j])) {
      return fail(record.not_finite());
    }
    fourier_transform(cells.phasors[j]);
    // With the amplitude removed rss falls by 2 |Z|^2 / n; the sum of n log(rss) is what is to be
    // smallest.
    const double total = cells.square[j] + std::numeric_limits<double>::min();
    for (std::size_t k = 0; k < length; ++k) {
      const double explained =
          std::min(2.0 * std::norm(cells.phasors[j][k]) / (cells.samples * total), 1.0 - 1e-12);
      power[k] -= std::log1p(-explained);
    }
  }
  const auto at = [&](std::ptrdiff_t k) {
    return power[static_cast<std::size_t>(k + static_cast<std::ptrdiff_t>(length)) % length];
  };
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(padding * half_range_bins));
  std::ptrdiff_t peak = -reach;
  for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
    if (at(k) > at(peak)) {
      peak = k;
    }
  }
  // A parabola through the peak and its neighbours, of the explained part, hits to a few hundredths
  // of a bin.
  const double low = -std::expm1(-at(peak - 1));
  const double high = -std::expm1(-at(peak + 1));
  const double bend = 2.0 * -std::expm1(-at(peak)) - low - high;
  const double between = bend > 0.0 ? 0.5 * (high - low) / bend : 0.0;
  GridPoint best;
  best.bins =
      (static_cast<double>(peak) + std::clamp(between, -0.5, 0.5)) / static_cast<double>(padding);
  best.misfit = -at(peak);
  best.significance = std::sqrt(std::expm1(at(peak)) * cells.samples);
  return best;
}

} // namespace

Expected<Frequency> search_frequency(const Record& record, const Frequency& start,
                                     double search_rel) {
  const double half_range_bins = search_rel * start.hz() * record.span_s();
  if (half_range_bins <= basin_bins) {
    return start;
  }
  const bool grid =
      half_range_bins < min_bins || start.hz() * (1.0 - search_rel) * record.span_s() < min_cycles;
  const double bin_hz = 1.0 / record.span_s();
  const auto search = [&](bool whole) -> Expected<GridPoint> {
    if (!grid) {
      return search_spectrum(record, start, half_range_bins, whole);
    }
    if (whole) {
      return search_grid(record, start, half_range_bins, bin_hz);
    }
    const Excerpt excerpt(record, part_of(record.size()));
    return excerpt.record().and_then(
        [&](const Record& part) { return search_grid(part, start, half_range_bins, bin_hz); });
  };
  const Selection part = part_of(record.size());
  const bool long_record = part.length < part.step;
  auto found = search(!long_record);
  if (found && found->significance < certain_amplitude && long_record) {
    found = search(true);
  }
  if (!found && found.error().code == ErrorCode::stamps_not_increasing) {
    return fail(record.not_increasing());
  }
  if (!found && found.error().code == ErrorCode::not_finite) {
    return fail(record.not_finite());
  }
  DYNCAL_TRY(found);
  return start.shifted_by_hz(found->bins * bin_hz);
}

} // namespace dyncal::analysis::kernel
