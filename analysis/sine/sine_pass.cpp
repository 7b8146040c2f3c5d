#include "analysis/sine/sine_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis::kernel {
namespace {

// The kernel's limit is 2^51 ns on either side of the origin.
constexpr std::int64_t max_span_ns = std::int64_t{1} << 51;

// Of blocks beside the grid, before it is given up.
constexpr std::size_t max_left_over = 8;

// Sums of any number of blocks, with what rounding took from them: the squares of a thousand blocks
// have the digits of one's.
class Totals {
public:
  explicit Totals(std::size_t channels) : sums_(4 + 4 * channels), rests_(4 + 4 * channels) {}

  void add(std::size_t samples, const DesignSums& design, std::span<const ResidualSums> residuals) {
    samples_ += static_cast<double>(samples);
    add(0, {design.s, design.c, design.ss, design.sc});
    for (std::size_t j = 0; j < residuals.size(); ++j) {
      add(j + 1, {residuals[j].e, residuals[j].es, residuals[j].ec, residuals[j].ee});
    }
  }

  [[nodiscard]] PassSums sums() const {
    PassSums result;
    result.samples = samples_;
    const auto [s, c, ss, sc] = four(0);
    result.design = {s, c, ss, sc};
    for (std::size_t j = 1; 4 * j < sums_.size(); ++j) {
      const auto [e, es, ec, ee] = four(j);
      result.channels.push_back({e, es, ec, ee});
    }
    return result;
  }

private:
  void add(std::size_t place, const std::array<double, 4>& values) {
    for (std::size_t k = 0; k < 4; ++k) {
      double& total = sums_[4 * place + k];
      const double sum = total + values[k];
      const double part = sum - total;
      rests_[4 * place + k] += (total - (sum - part)) + (values[k] - part);
      total = sum;
    }
  }
  [[nodiscard]] std::array<double, 4> four(std::size_t place) const {
    std::array<double, 4> result;
    for (std::size_t k = 0; k < 4; ++k) {
      result[k] = sums_[4 * place + k] + rests_[4 * place + k];
    }
    return result;
  }

  double samples_ = 0.0;
  std::vector<double> sums_, rests_;
};

// Stretches of a record, summed one after the other.
class Stretches {
public:
  Stretches(const Record& record, const Frequency& frequency, std::span<const Parameters> start)
      : kernel_(best_kernel()), record_(record), axis_(record.axis(frequency)), start_(start),
        totals_(start.size()), values_(start.size()), residuals_(start.size()) {}

  // All samples of a stretch, at most a block. False: stamps do not increase.
  bool add(std::size_t first, std::size_t n) {
    const std::int64_t* stamps = begin(first);
    DesignSums design{};
    if (!kernel_.fit_block(stamps, n, axis_, values_.data(), start_.size(), start_.data(), design,
                           residuals_.data())) {
      return false;
    }
    totals_.add(n, design, residuals_);
    return follows(first);
  }

  // The leading blocks of a stretch that are near the grid; how many samples these are.
  std::size_t add_on_grid(std::size_t first, std::size_t n, const SampleGrid& grid) {
    const std::int64_t* stamps = begin(first);
    DesignSums design{};
    std::size_t near = n;
    for (std::size_t j = 0; j < start_.size() && near > 0; j += grid_call_channels) {
      const std::size_t channels = std::min(grid_call_channels, start_.size() - j);
      near = kernel_.fit_on_grid(stamps, near, axis_, grid, values_.data() + j, channels,
                                 start_.data() + j, design, residuals_.data() + j);
    }
    if (near > 0) {
      totals_.add(near, design, residuals_);
    }
    for (std::size_t i = 0; i < near; i += grid_samples) {
      increasing_ &= follows(first + i);
    }
    return near;
  }

  [[nodiscard]] bool increasing() const {
    return increasing_;
  } // across the blocks of add_on_grid()
  [[nodiscard]] PassSums sums() const { return totals_.sums(); }

private:
  const std::int64_t* begin(std::size_t first) {
    for (std::size_t j = 0; j < values_.size(); ++j) {
      values_[j] = record_.channels()[j].data() + first;
    }
    return record_.stamps().data() + first;
  }
  [[nodiscard]] bool follows(std::size_t i) const {
    return i == 0 || record_.stamps()[i] > record_.stamps()[i - 1];
  }

  const SineKernel& kernel_;
  const Record& record_;
  TimeAxis axis_;
  std::span<const Parameters> start_;
  Totals totals_;
  std::vector<const double*> values_;
  std::vector<ResidualSums> residuals_;
  bool increasing_ = true;
};

} // namespace

Record::Record(std::span<const std::int64_t> stamps, Channels channels)
    : stamps_(stamps), channels_(channels) {
  const std::int64_t span = stamps.back() - stamps.front();
  origin_ns_ = stamps.front() + span / 2;
  span_s_ = static_cast<double>(span) * 1e-9;
}

Expected<Record> Record::make(std::span<const std::int64_t> stamps_ns, Channels channels,
                              std::size_t parameters) {
  if (channels.empty()) {
    return fail(ErrorCode::invalid_argument, "a sine approximation needs at least one channel");
  }
  for (std::size_t j = 0; j < channels.size(); ++j) {
    if (channels[j].size() != stamps_ns.size()) {
      return fail(ErrorCode::invalid_argument,
                  "channel " + std::to_string(j) + " has " + std::to_string(channels[j].size()) +
                      " samples but there are " + std::to_string(stamps_ns.size()) + " stamps");
    }
  }
  if (stamps_ns.size() <= parameters) {
    return fail(ErrorCode::too_few_samples, "the record has " + std::to_string(stamps_ns.size()) +
                                                " samples, a fit of " + std::to_string(parameters) +
                                                " parameters needs at least " +
                                                std::to_string(parameters + 1));
  }
  std::int64_t span = 0;
  const bool overflow = __builtin_sub_overflow(stamps_ns.back(), stamps_ns.front(), &span);
  if (overflow ? stamps_ns.back() < stamps_ns.front() : span <= 0) {
    return fail(
        ErrorCode::stamps_not_increasing,
        "the last stamp of the record is not later than the first; sort the record by time");
  }
  if (overflow || span > max_span_ns) {
    return fail(ErrorCode::invalid_argument,
                "the record spans more than 26 days; evaluate it in parts");
  }
  return Record(stamps_ns, channels);
}

Expected<void> Record::check_nyquist(const Frequency& frequency) const {
  const double mean_rate_hz = static_cast<double>(size() - 1) / span_s_;
  if (frequency.hz() <= 0.5 * mean_rate_hz) {
    return {};
  }
  std::vector<std::int64_t> intervals(size() - 1);
  for (std::size_t i = 0; i + 1 < size(); ++i) {
    intervals[i] = stamps_[i + 1] - stamps_[i];
  }
  const std::int64_t usual_ns = upper_median(intervals);
  if (usual_ns <= 0) {
    return fail(not_increasing());
  }
  const double rate_hz = 1e9 / static_cast<double>(usual_ns);
  if (frequency.hz() <= 0.5 * rate_hz) {
    return {};
  }
  // On a lattice of intervals the alias a whole number of turns per interval away fits as well;
  // uneven intervals tell them apart.
  const double turns = std::max(1.0, std::round(frequency.hz() / rate_hz));
  double in_step = 0.0;
  for (const std::int64_t interval : intervals) {
    in_step +=
        std::cos(2.0 * std::numbers::pi * turns * static_cast<double>(interval) * rate_hz * 1e-9);
  }
  if (std::abs(in_step) < 0.5 * static_cast<double>(intervals.size())) {
    return {};
  }
  return fail(ErrorCode::frequency_out_of_range,
              "the frequency of " + std::to_string(frequency.hz()) +
                  " Hz is above half the sample rate of " + std::to_string(rate_hz) + " Hz");
}

void Record::fetch_beginning() const {
  constexpr std::size_t samples_of_a_line = 8;
  const std::size_t samples =
      std::min(fetched_ahead_samples, size()); // from where on the kernels fetch for themselves
  for (std::size_t i = 0; i < samples; i += samples_of_a_line) {
    __builtin_prefetch(stamps_.data() + i, 0, 2);
    for (const std::span<const double>& channel : channels_) {
      __builtin_prefetch(channel.data() + i, 0, 2);
    }
  }
}

TimeAxis Record::axis(const Frequency& frequency) const {
  return {frequency.turns_per_ns_high(), frequency.turns_per_ns_low(), origin_ns_,
          1.0 / half_span_ns()};
}

Error Record::not_increasing() const {
  const auto later = std::adjacent_find(stamps_.begin(), stamps_.end(),
                                        [](std::int64_t a, std::int64_t b) { return b <= a; });
  const auto index = std::distance(stamps_.begin(), later) + 1;
  return {ErrorCode::stamps_not_increasing,
          "the stamp of sample " + std::to_string(index) +
              " is not later than the one before; remove duplicates and sort the record by time"};
}

Error Record::not_finite() const {
  for (std::size_t j = 0; j < channels_.size(); ++j) {
    const auto bad = std::find_if_not(channels_[j].begin(), channels_[j].end(),
                                      [](double y) { return std::isfinite(y); });
    if (bad != channels_[j].end()) {
      return {ErrorCode::not_finite,
              "sample " + std::to_string(std::distance(channels_[j].begin(), bad)) +
                  " of channel " + std::to_string(j) + " is not a finite number"};
    }
  }
  return {ErrorCode::not_finite, "the values are too large to be squared; scale them"};
}

Expected<PassSums> accumulate(const Record& record, const Frequency& frequency,
                              std::span<const Parameters> start, Selection selection) {
  Stretches stretches(record, frequency, start);
  for (std::size_t i = 0; i < record.size(); i += selection.step) {
    if (!stretches.add(i, std::min(selection.length, record.size() - i))) {
      return fail(record.not_increasing());
    }
  }
  return stretches.sums();
}

Expected<PassSums> accumulate(const Record& record, const Frequency& frequency,
                              std::span<const Parameters> start,
                              std::span<const std::int64_t> stamps,
                              std::span<const double> values) {
  std::vector<const double*> channels(start.size());
  for (std::size_t j = 0; j < start.size(); ++j) {
    channels[j] = values.data() + j * stamps.size();
  }
  PassSums sums;
  sums.samples = static_cast<double>(stamps.size());
  sums.channels.resize(start.size());
  const bool increasing =
      best_kernel().fit_block(stamps.data(), stamps.size(), record.axis(frequency), channels.data(),
                              start.size(), start.data(), sums.design, sums.channels.data());
  if (!increasing) {
    return fail(record.not_increasing());
  }
  return sums;
}

Expected<PassSums> accumulate(const Record& record, const Frequency& frequency,
                              std::span<const Parameters> start, const SampleGrid& grid) {
  Stretches stretches(record, frequency, start);
  std::size_t left_over = 0; // blocks that were not near the grid, less those that were
  for (std::size_t i = 0; i < record.size();) {
    const std::size_t rest = record.size() - i;
    const std::size_t near =
        left_over < max_left_over
            ? stretches.add_on_grid(i, std::min(rest / lanes * lanes, grid_call_samples), grid)
            : 0;
    left_over -= std::min(left_over, near / grid_samples);
    i += near;
    if (near > 0 || i == record.size()) {
      continue;
    }
    ++left_over;
    const std::size_t n = std::min(rest, grid_samples);
    if (!stretches.add(i, n)) {
      return fail(record.not_increasing());
    }
    i += n;
  }
  if (!stretches.increasing()) {
    return fail(record.not_increasing());
  }
  return stretches.sums();
}

bool all_finite(const PassSums& sums) {
  return std::all_of(sums.channels.begin(), sums.channels.end(),
                     [](const ResidualSums& s) { return std::isfinite(s.ee); });
}

} // namespace dyncal::analysis::kernel
