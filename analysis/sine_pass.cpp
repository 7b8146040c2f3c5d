#include "analysis/sine_pass.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace dyncal::analysis::kernel {
namespace {

// The kernel's limit is 2^51 ns on either side of the origin.
constexpr std::int64_t longest_span_ns = std::int64_t{1} << 51;

tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected(Error{code, std::move(message)});
}

void add(DesignSums& total, const DesignSums& block) {
  total.s += block.s;
  total.c += block.c;
  total.ss += block.ss;
  total.sc += block.sc;
}

void add(ResidualSums& total, const ResidualSums& block) {
  total.e += block.e;
  total.es += block.es;
  total.ec += block.ec;
  total.ee += block.ee;
}

// Powers of the middle of a block.
struct Powers {
  double value[moment_count];
  explicit Powers(double u) {
    value[0] = 1.0;
    for (std::size_t m = 1; m < moment_count; ++m)
      value[m] = value[m - 1] * u;
  }
};

// sum u^m f over a block, for m >= 3, from its first three moments: u = middle + v, powers of v above the second left out.
void add_high_orders(double* total, const Powers& middle, double zero, double one, double two) {
  const double b = middle.value[1];
  const double v1 = one - b * zero;
  const double v2 = two - b * (2.0 * one - b * zero);
  for (std::size_t m = 3; m < moment_count; ++m) {
    const double order = static_cast<double>(m);
    total[m] += middle.value[m] * zero + order * middle.value[m - 1] * v1 + 0.5 * order * (order - 1.0) * middle.value[m - 2] * v2;
  }
}

void add(DesignMoments& total, const Powers& middle, double n, const DesignSums& sums, const SlopeSums& slope) {
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
void add(ResidualMoments& total, const Powers& middle, const ResidualSums& sums, const ResidualSlopeSums& slope) {
  total.e += sums.e;
  total.ee += sums.ee;
  total.us[0] += sums.es;
  total.uc[0] += sums.ec;
  total.us[1] += slope.eus;
  total.uc[1] += slope.euc;
  for (std::size_t m = 2; m < moment_count; ++m) {
    const double order = static_cast<double>(m);
    total.us[m] += order * middle.value[m - 1] * slope.eus - (order - 1.0) * middle.value[m] * sums.es;
    total.uc[m] += order * middle.value[m - 1] * slope.euc - (order - 1.0) * middle.value[m] * sums.ec;
  }
}

} // namespace

Record::Record(std::span<const std::int64_t> stamps, Channels channels) : stamps_(stamps), channels_(channels) {
  const std::int64_t span = stamps.back() - stamps.front();
  origin_ns_ = stamps.front() + span / 2;
  span_s_ = static_cast<double>(span) * 1e-9;
}

Expected<Record> Record::make(std::span<const std::int64_t> stamps_ns, Channels channels, std::size_t parameters) {
  if (channels.empty()) return fail(ErrorCode::invalid_argument, "a sine approximation needs at least one channel");
  for (std::size_t j = 0; j < channels.size(); ++j) {
    if (channels[j].size() != stamps_ns.size()) {
      return fail(ErrorCode::invalid_argument, "channel " + std::to_string(j) + " has " + std::to_string(channels[j].size()) +
                                                   " samples but there are " + std::to_string(stamps_ns.size()) + " stamps");
    }
  }
  if (stamps_ns.size() <= parameters) {
    return fail(ErrorCode::too_few_samples, "the record has " + std::to_string(stamps_ns.size()) + " samples, a fit of " +
                                                std::to_string(parameters) + " parameters needs at least " +
                                                std::to_string(parameters + 1));
  }
  std::int64_t span = 0;
  const bool overflow = __builtin_sub_overflow(stamps_ns.back(), stamps_ns.front(), &span);
  if (overflow ? stamps_ns.back() < stamps_ns.front() : span <= 0) {
    return fail(ErrorCode::stamps_not_increasing, "the last stamp of the record is not later than the first; sort the record by time");
  }
  if (overflow || span > longest_span_ns) {
    return fail(ErrorCode::invalid_argument, "the record spans more than 26 days; evaluate it in parts");
  }
  return Record(stamps_ns, channels);
}

Expected<void> Record::carries(const Frequency& frequency) const {
  const double mean_rate_hz = static_cast<double>(size() - 1) / span_s_;
  if (frequency.hz() <= 0.5 * mean_rate_hz) return {};
  std::vector<std::int64_t> intervals(size() - 1);
  for (std::size_t i = 0; i + 1 < size(); ++i)
    intervals[i] = stamps_[i + 1] - stamps_[i];
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  if (*middle <= 0) return tl::unexpected(not_increasing());
  const double rate_hz = 1e9 / static_cast<double>(*middle);
  if (frequency.hz() <= 0.5 * rate_hz) return {};
  // On a lattice of intervals the alias a whole number of turns per interval away fits as well; uneven intervals tell them apart.
  const double turns = std::max(1.0, std::round(frequency.hz() / rate_hz));
  double in_step = 0.0;
  for (const std::int64_t interval : intervals)
    in_step += std::cos(2.0 * std::numbers::pi * turns * static_cast<double>(interval) * rate_hz * 1e-9);
  if (std::abs(in_step) < 0.5 * static_cast<double>(intervals.size())) return {};
  return fail(ErrorCode::frequency_out_of_range, "the frequency of " + std::to_string(frequency.hz()) +
                                                     " Hz is above half the sample rate of " + std::to_string(rate_hz) + " Hz");
}

TimeAxis Record::axis(const Frequency& frequency) const {
  return {frequency.turns_per_ns_high(), frequency.turns_per_ns_low(), origin_ns_, 1.0 / half_span_ns()};
}

Error Record::not_increasing() const {
  const auto later = std::adjacent_find(stamps_.begin(), stamps_.end(), [](std::int64_t a, std::int64_t b) { return b <= a; });
  const auto index = std::distance(stamps_.begin(), later) + 1;
  return {ErrorCode::stamps_not_increasing, "the stamp of sample " + std::to_string(index) +
                                                " is not later than the one before; remove duplicates and sort the record by time"};
}

Error Record::not_finite() const {
  for (std::size_t j = 0; j < channels_.size(); ++j) {
    const auto bad = std::find_if_not(channels_[j].begin(), channels_[j].end(), [](double y) { return std::isfinite(y); });
    if (bad != channels_[j].end()) {
      return {ErrorCode::not_finite, "sample " + std::to_string(std::distance(channels_[j].begin(), bad)) + " of channel " +
                                         std::to_string(j) + " is not a finite number"};
    }
  }
  return {ErrorCode::not_finite, "the values are too large to be squared; scale them"};
}

Expected<PassSums> accumulate(const Record& record, const Frequency& frequency, std::span<const Parameters> start, Selection selection) {
  const SineKernel& kernel = best_kernel();
  const TimeAxis axis = record.axis(frequency);
  const std::int64_t* stamps = record.stamps().data();
  const std::size_t count = start.size();
  std::vector<const double*> values(count);
  std::vector<ResidualSums> block(count);
  PassSums result;
  result.channels.resize(record.channels().size());
  for (std::size_t i = 0; i < record.size(); i += selection.step) {
    const std::size_t n = std::min(selection.length, record.size() - i);
    for (std::size_t j = 0; j < count; ++j)
      values[j] = record.channels()[j].data() + i;
    DesignSums design;
    const bool increasing = kernel.fit_block(stamps + i, n, axis, values.data(), count, start.data(), design, block.data());
    if (!increasing || (i > 0 && stamps[i] <= stamps[i - 1])) return tl::unexpected(record.not_increasing());
    add(result.design, design);
    result.samples += static_cast<double>(n);
    for (std::size_t j = 0; j < count; ++j)
      add(result.channels[j], block[j]);
  }
  return result;
}

bool all_finite(const PassSums& sums) {
  return std::all_of(sums.channels.begin(), sums.channels.end(), [](const ResidualSums& s) { return std::isfinite(s.ee); });
}

Expected<SeriesSums> accumulate_series(const Record& record, const Frequency& frequency, std::span<const Parameters> start,
                                       Selection selection) {
  const SineKernel& kernel = best_kernel();
  const TimeAxis axis = record.axis(frequency);
  const std::int64_t* stamps = record.stamps().data();
  BlockBasis basis;
  DesignMoments design{};
  std::vector<ResidualMoments> channels(start.size(), ResidualMoments{});
  SeriesSums result;
  for (std::size_t i = 0; i < record.size(); i += selection.step) {
    const std::size_t n = std::min(selection.length, record.size() - i);
    DesignSums sums;
    SlopeSums slope;
    const bool increasing = kernel.design_with_slope(stamps + i, n, axis, basis, sums, slope);
    if (!increasing || (i > 0 && stamps[i] <= stamps[i - 1])) return tl::unexpected(record.not_increasing());
    const Powers middle(0.5 * (basis.u[0] + basis.u[n - 1]));
    result.block_half_length = std::max(result.block_half_length, 0.5 * (basis.u[n - 1] - basis.u[0]));
    add(design, middle, static_cast<double>(n), sums, slope);
    for (std::size_t j = 0; j < start.size(); ++j) {
      ResidualSums residuals;
      ResidualSlopeSums residual_slopes;
      kernel.residuals_with_slope(record.channels()[j].data() + i, n, basis, start[j], residuals, residual_slopes);
      add(channels[j], middle, residuals, residual_slopes);
    }
  }
  result.design = design_series(design, 0.0);
  for (const ResidualMoments& moments : channels)
    result.channels.push_back(residual_series(moments));
  return result;
}

bool all_finite(const SeriesSums& sums) {
  return std::all_of(sums.channels.begin(), sums.channels.end(), [](const ResidualSeries& s) { return std::isfinite(s.ee); });
}

} // namespace dyncal::analysis::kernel
