// The pass of sine_pass.hpp that also gathers the series in the frequency.
#include <algorithm>
#include <cmath>

#include "analysis/sine/sine_pass.hpp"

namespace dyncal::analysis::kernel {
namespace {

// Powers of the middle of a block.
struct Powers {
  double value[moment_count];
  explicit Powers(double u) {
    value[0] = 1.0;
    for (std::size_t m = 1; m < moment_count; ++m) {
      value[m] = value[m - 1] * u;
    }
  }
};

// sum u^m f over a block, for m >= 3, from its first three moments: u = middle + v, powers of v
// above the second left out.
void add_high_orders(double* total, const Powers& middle, double zero, double one, double two) {
  const double b = middle.value[1];
  const double v1 = one - b * zero;
  const double v2 = two - b * (2.0 * one - b * zero);
  for (std::size_t m = 3; m < moment_count; ++m) {
    const double order = static_cast<double>(m);
    total[m] += middle.value[m] * zero + order * middle.value[m - 1] * v1 +
                0.5 * order * (order - 1.0) * middle.value[m - 2] * v2;
  }
}

void add(DesignMoments& total, const Powers& middle, double n, const DesignSums& sums,
         const SlopeSums& slope) {
  const auto add_one = [&](double* moments, double zero, double one, double two) {
    moments[0] += zero;
    moments[1] += one;
    moments[2] += two;
    add_high_orders(moments, middle, zero, one, two);
  };
  add_one(total.u, n, slope.u, slope.uu);
  add_one(total.us, sums.s, slope.us, slope.uus);
  add_one(total.uc, sums.c, slope.uc, slope.uuc);
  add_one(total.uss, sums.ss, slope.uss, slope.uuss);
  add_one(total.usc, sums.sc, slope.usc, slope.uusc);
}

// Residual moments for m >= 2 from the first two.
void add(ResidualMoments& total, const Powers& middle, const ResidualSums& sums,
         const ResidualSlopeSums& slope) {
  total.e += sums.e;
  total.ee += sums.ee;
  total.us[0] += sums.es;
  total.uc[0] += sums.ec;
  total.us[1] += slope.eus;
  total.uc[1] += slope.euc;
  for (std::size_t m = 2; m < moment_count; ++m) {
    const double order = static_cast<double>(m);
    total.us[m] +=
        order * middle.value[m - 1] * slope.eus - (order - 1.0) * middle.value[m] * sums.es;
    total.uc[m] +=
        order * middle.value[m - 1] * slope.euc - (order - 1.0) * middle.value[m] * sums.ec;
  }
}

class FrequencySeriesPass {
public:
  FrequencySeriesPass(const Record& record, const Frequency& frequency,
                      std::span<const Parameters> start)
      : kernel_(best_kernel()), record_(record), axis_(record.axis(frequency)), start_(start),
        channels_(start.size(), ResidualMoments{}), values_(start.size()), residuals_(start.size()),
        residual_slopes_(start.size()) {}

  // A block; false: stamps do not increase.
  bool add(std::size_t first, std::size_t n) {
    const std::int64_t* stamps = record_.stamps().data() + first;
    BlockBasis basis;
    DesignSums sums;
    SlopeSums slope;
    if (!kernel_.design_with_slope(stamps, n, axis_, basis, sums, slope)) {
      return false;
    }
    for (std::size_t j = 0; j < start_.size(); ++j) {
      kernel_.residuals_with_slope(record_.channels()[j].data() + first, n, basis, start_[j],
                                   residuals_[j], residual_slopes_[j]);
    }
    take(first, n, sums, slope);
    return follows(first);
  }

  // The leading blocks of a stretch that are near the grid, as one; how many samples were taken.
  std::size_t add_on_grid(std::size_t first, std::size_t n, const SampleGrid& grid) {
    for (std::size_t j = 0; j < start_.size(); ++j) {
      values_[j] = record_.channels()[j].data() + first;
    }
    std::size_t near = n / lanes * lanes;
    DesignSums sums{};
    SlopeSums slope{};
    for (std::size_t j = 0; j < start_.size() && near > 0; j += grid_call_channels) {
      near = kernel_.series_on_grid(
          record_.stamps().data() + first, near, axis_, grid, values_.data() + j,
          std::min(grid_call_channels, start_.size() - j), start_.data() + j, sums, slope,
          residuals_.data() + j, residual_slopes_.data() + j);
    }
    for (std::size_t i = 0; i < near; i += grid_samples) {
      increasing_ &= follows(first + i);
    }
    if (near > 0) {
      take(first, near, sums, slope);
    }
    return near;
  }

  [[nodiscard]] bool increasing() const {
    return increasing_;
  } // across the blocks of add_on_grid()
  [[nodiscard]] FrequencySeriesSums sums() const {
    FrequencySeriesSums result;
    result.block_half_length = block_half_length_;
    result.design = design_frequency_series(design_, 0.0);
    for (const ResidualMoments& moments : channels_) {
      result.channels.push_back(residual_frequency_series(moments));
    }
    return result;
  }

private:
  void take(std::size_t first, std::size_t n, const DesignSums& sums, const SlopeSums& slope) {
    const auto place = [&](std::size_t i) {
      return static_cast<double>(record_.stamps()[i] - axis_.origin_ns) * axis_.inverse_scale;
    };
    const double begin = place(first);
    const double end = place(first + n - 1);
    const Powers middle(0.5 * (begin + end));
    block_half_length_ = std::max(block_half_length_, 0.5 * (end - begin));
    kernel::add(design_, middle, static_cast<double>(n), sums, slope);
    for (std::size_t j = 0; j < start_.size(); ++j) {
      kernel::add(channels_[j], middle, residuals_[j], residual_slopes_[j]);
    }
  }
  [[nodiscard]] bool follows(std::size_t i) const {
    return i == 0 || record_.stamps()[i] > record_.stamps()[i - 1];
  }

  const SineKernel& kernel_;
  const Record& record_;
  TimeAxis axis_;
  std::span<const Parameters> start_;
  DesignMoments design_{};
  std::vector<ResidualMoments> channels_;
  double block_half_length_ = 0.0;
  bool increasing_ = true;
  std::vector<const double*> values_;
  std::vector<ResidualSums> residuals_;
  std::vector<ResidualSlopeSums> residual_slopes_;
};

} // namespace

Expected<FrequencySeriesSums> accumulate_frequency_series(const Record& record,
                                                          const Frequency& frequency,
                                                          std::span<const Parameters> start,
                                                          Selection selection) {
  const auto grid = sample_grid(record.stamps(), frequency);
  FrequencySeriesPass pass(record, frequency, start);
  for (std::size_t i = 0; i < record.size(); i += selection.step) {
    const std::size_t n = std::min(selection.length, record.size() - i);
    for (std::size_t done = grid ? pass.add_on_grid(i, n, *grid) : 0; done < n;) {
      const std::size_t rest = std::min(n - done, block_samples);
      if (!pass.add(i + done, rest)) {
        return fail(record.not_increasing());
      }
      done += rest;
    }
  }
  if (!pass.increasing()) {
    return fail(record.not_increasing());
  }
  return pass.sums();
}

bool all_finite(const FrequencySeriesSums& sums) {
  return std::all_of(sums.channels.begin(), sums.channels.end(),
                     [](const ResidualFrequencySeries& s) { return std::isfinite(s.ee); });
}

} // namespace dyncal::analysis::kernel
