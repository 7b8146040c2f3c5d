#include "drivers/interferometer/decimated_channels.hpp"

#include <algorithm>
#include <utility>

namespace dyncal::drivers::interferometer {
namespace {

bool same(const RegularClock& one, const RegularClock& other) {
  return one.origin_ns == other.origin_ns &&
         one.interval_numerator_ns == other.interval_numerator_ns &&
         one.interval_denominator == other.interval_denominator;
}

} // namespace

DecimatedChannels::DecimatedChannels(std::size_t factor, std::size_t channels)
    : factor_(factor), outputs_(channels) {}

void DecimatedChannels::begin_at(const SampleBlock& block) {
  filters_.assign(outputs_.size(), analysis::DecimationFilter(factor_, analysis::PassBand::flat));
  const std::uint64_t earliest = block.first_sample + filters_.front().first_sample();
  next_output_ = (earliest + factor_ - 1) / factor_;
  skipped_ = next_output_ * factor_ - earliest;
  first_instant_ = (block.first_sample + factor_ - 1) / factor_;
  instants_.clear();
  clock_ = block.clock;
}

void DecimatedChannels::note_instants(const SampleBlock& block) {
  const std::uint64_t end = block.first_sample + block.samples;
  std::uint64_t number = (block.first_sample + factor_ - 1) / factor_ * factor_;
  for (; number < end; number += factor_) {
    const std::size_t i = number - block.first_sample;
    Instant instant{block.clock ? block.clock->stamp_ns(number) : block.stamps_ns[i]};
    instant.uncertainty_ns = block.stamp_uncertainty_ns.empty() ? 0 : block.stamp_uncertainty_ns[i];
    instant.flags = block.flags.empty() ? std::uint8_t{0} : block.flags[i];
    instants_.push_back(instant);
  }
}

void DecimatedChannels::add_instants(const SampleBlock& block, SampleBlock& output) {
  for (; first_instant_ < output.first_sample; ++first_instant_) {
    instants_.pop_front();
  }
  if (clock_) {
    output.clock = clock_;
    output.clock->interval_numerator_ns *= static_cast<std::int64_t>(factor_);
  }
  bool any_flag = false;
  for (std::size_t i = 0; i < output.samples; ++i, ++first_instant_) {
    const Instant instant = instants_.front();
    instants_.pop_front();
    if (!clock_) {
      output.stamps_ns.push_back(instant.stamp_ns);
    }
    if (!block.stamp_uncertainty_ns.empty()) {
      output.stamp_uncertainty_ns.push_back(instant.uncertainty_ns);
    }
    output.flags.push_back(instant.flags);
    any_flag |= instant.flags != 0;
  }
  if (!any_flag) {
    output.flags.clear();
  }
  output.received_utc_ns = block.received_utc_ns;
}

SampleBlock DecimatedChannels::push(const SampleBlock& block,
                                    std::span<const std::span<const double>> columns) {
  if (!next_ || is_behind_gap(block)) {
    begin_at(block);
  } else if (clock_ && (!block.clock || !same(*block.clock, *clock_))) {
    clock_.reset();
  }
  next_ = block.first_sample + block.samples;
  note_instants(block);
  const std::size_t skipped = std::min(skipped_, block.samples);
  skipped_ -= skipped;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    outputs_[i].clear();
    filters_[i].push(columns[i].subspan(skipped), outputs_[i]);
  }
  SampleBlock output;
  output.first_sample = next_output_;
  output.samples = outputs_.front().size();
  next_output_ += output.samples;
  for (const std::vector<double>& values : outputs_) {
    output.values.insert(output.values.end(), values.begin(), values.end());
  }
  add_instants(block, output);
  return output;
}

} // namespace dyncal::drivers::interferometer
