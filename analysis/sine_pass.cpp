#include "analysis/sine_pass.hpp"

#include <algorithm>
#include <cmath>
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
  const double rate_hz = static_cast<double>(size() - 1) / span_s_;
  if (frequency.hz() > 0.5 * rate_hz) {
    return fail(ErrorCode::frequency_out_of_range, "the frequency of " + std::to_string(frequency.hz()) +
                                                       " Hz is above half the mean sample rate of " + std::to_string(rate_hz) + " Hz");
  }
  return {};
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
  BlockBasis basis;
  PassSums result;
  result.channels.resize(record.channels().size());
  for (std::size_t i = 0; i < record.size(); i += selection.step) {
    const std::size_t n = std::min(selection.length, record.size() - i);
    DesignSums design;
    const bool increasing = kernel.design(stamps + i, n, axis, basis, design);
    if (!increasing || (i > 0 && stamps[i] <= stamps[i - 1])) return tl::unexpected(record.not_increasing());
    add(result.design, design);
    result.samples += static_cast<double>(n);
    for (std::size_t j = 0; j < start.size(); ++j) {
      ResidualSums sums;
      kernel.residuals(record.channels()[j].data() + i, n, basis, start[j], sums);
      add(result.channels[j], sums);
    }
  }
  return result;
}

bool all_finite(const PassSums& sums) {
  return std::all_of(sums.channels.begin(), sums.channels.end(), [](const ResidualSums& s) { return std::isfinite(s.ee); });
}

} // namespace dyncal::analysis::kernel
