#include "drivers/smartup/block_assembly.hpp"

#include <bit>
#include <cmath>
#include <limits>

namespace dyncal::drivers::smartup {

namespace {

constexpr std::size_t max_samples = 4096;

// Behind `values`; returns their new end.
double* append_columns(double* values, const std::vector<SampleRow>& rows, std::uint16_t columns,
                       std::uint16_t SampleRow::*present,
                       std::array<float, channels_of_unit> SampleRow::*measured) {
  constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t channel = 0; channel < channels_of_unit; ++channel) {
    if ((columns & (1U << channel)) == 0) {
      continue;
    }
    for (const SampleRow& row : rows) {
      *values++ = (row.*present & (1U << channel)) != 0
                      ? static_cast<double>((row.*measured)[channel])
                      : not_measured;
    }
  }
  return values;
}

} // namespace

SampleBlock BlockAssembly::take() {
  SampleBlock block;
  block.first_sample = rows_.front().sample;
  block.samples = rows_.size();
  block.stamps_ns.reserve(rows_.size());
  block.stamp_uncertainty_ns.reserve(rows_.size());
  unsigned any_flag = 0;
  for (const SampleRow& row : rows_) {
    block.stamps_ns.push_back(row.stamp_ns);
    block.stamp_uncertainty_ns.push_back(row.stamp_uncertainty_ns);
    any_flag |= row.flags;
  }
  if (any_flag != 0) {
    block.flags.reserve(rows_.size());
    for (const SampleRow& row : rows_) {
      block.flags.push_back(row.flags);
    }
  }
  block.values.resize(rows_.size() * static_cast<std::size_t>(std::popcount(columns_.own) +
                                                              std::popcount(columns_.sync)));
  double* const sync = append_columns(block.values.data(), rows_, columns_.own, &SampleRow::present,
                                      &SampleRow::values);
  append_columns(sync, rows_, columns_.sync, &SampleRow::sync_present, &SampleRow::sync_values);
  block.received_utc_ns = last_arrival_.utc_ns;
  rows_.clear();
  return block;
}

void BlockAssembly::append(const SampleRow& row, HostTime arrival) {
  if (rows_.empty()) {
    first_arrival_ = arrival;
  }
  rows_.push_back(row);
  next_sample_ = row.sample + 1;
  last_arrival_ = arrival;
}

bool BlockAssembly::is_full(double period_ns, HostTime arrival) const {
  const bool is_long =
      period_ns > 0.0
          ? static_cast<double>(rows_.size()) * period_ns >= static_cast<double>(block_ns_)
          : arrival.monotonic_ns - first_arrival_.monotonic_ns >= block_ns_;
  return is_long || rows_.size() >= max_samples;
}

std::optional<SampleBlock> BlockAssembly::add(const SampleRow& row, double period_ns,
                                              HostTime arrival) {
  if (!rows_.empty() && row.sample != next_sample_) {
    SampleBlock before_gap = take();
    append(row, arrival); // a block of one sample never fills in the same step
    return before_gap;
  }
  append(row, arrival);
  if (!is_full(period_ns, arrival)) {
    return std::nullopt;
  }
  return take();
}

std::optional<SampleBlock> BlockAssembly::flush(std::optional<HostTime> now) {
  if (rows_.empty() || (now && now->monotonic_ns - first_arrival_.monotonic_ns < 2 * block_ns_)) {
    return std::nullopt;
  }
  return take();
}

std::size_t BlockAssembly::discard() {
  const std::size_t held = rows_.size();
  rows_.clear();
  return held;
}

} // namespace dyncal::drivers::smartup
