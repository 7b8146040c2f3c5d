#include "drivers/can/growing_block.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace dyncal::drivers::can {

bool GrowingBlock::must_go_before(std::uint64_t number, std::int64_t stamp_ns) const {
  return !empty() && (number != next_number_ || stamp_ns - block_.stamps_ns.front() >= max_span_ns);
}

bool GrowingBlock::add(SampleHead head, const std::vector<double>& values) {
  if (last_stamp_ns_ && head.stamp_ns <= *last_stamp_ns_) {
    head.flags |= head.stamp_ns == *last_stamp_ns_ ? stamp_repeated : stamp_backwards;
  }
  last_stamp_ns_ = head.stamp_ns;
  if (empty()) {
    block_.first_sample = head.number;
  }
  ++block_.samples;
  block_.stamps_ns.push_back(head.stamp_ns);
  block_.stamp_uncertainty_ns.push_back(static_cast<std::uint32_t>(
      std::min(head.u_stamp_s * 1e9, double{std::numeric_limits<std::uint32_t>::max()})));
  block_.flags.push_back(head.flags);
  block_.received_utc_ns = head.received_utc_ns;
  rows_.insert(rows_.end(), values.begin(), values.end());
  next_number_ = head.number + 1;
  return head.flags == 0;
}

SampleBlock GrowingBlock::release() {
  const std::size_t channels = empty() ? 0 : rows_.size() / block_.samples;
  block_.values.resize(rows_.size());
  for (std::size_t sample = 0; sample < block_.samples; ++sample) {
    for (std::size_t channel = 0; channel < channels; ++channel) {
      block_.values[channel * block_.samples + sample] = rows_[sample * channels + channel];
    }
  }
  rows_.clear();
  return std::exchange(block_, {});
}

} // namespace dyncal::drivers::can
