#include "services/stream/block_split.hpp"

#include <algorithm>
#include <utility>

namespace dyncal::inline stream {

namespace {

template <class T>
std::vector<T> part_of(const std::vector<T>& all, std::size_t first, std::size_t count) {
  if (all.empty()) {
    return {};
  }
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

std::size_t bytes_of(const drivers::SampleBlock& block) {
  return block.values.size() * sizeof(double) + block.stamps_ns.size() * sizeof(std::int64_t) +
         block.stamp_uncertainty_ns.size() * sizeof(std::uint32_t) + block.flags.size();
}

} // namespace

std::vector<drivers::SampleBlock> split(drivers::SampleBlock block, std::size_t max_bytes) {
  std::vector<drivers::SampleBlock> parts;
  const std::size_t bytes = bytes_of(block);
  if (bytes <= max_bytes || block.samples < 2) {
    parts.push_back(std::move(block));
    return parts;
  }
  const std::size_t bytes_per_sample = (bytes + block.samples - 1) / block.samples;
  const std::size_t samples = std::max<std::size_t>(1, max_bytes / bytes_per_sample);
  const std::size_t channels = block.values.size() / block.samples;
  for (std::size_t first = 0; first < block.samples; first += samples) {
    const std::size_t count = std::min(samples, block.samples - first);
    drivers::SampleBlock& part = parts.emplace_back();
    part.first_sample = block.first_sample + first;
    part.samples = count;
    part.clock = block.clock;
    part.stamps_ns = part_of(block.stamps_ns, first, count);
    part.stamp_uncertainty_ns = part_of(block.stamp_uncertainty_ns, first, count);
    part.flags = part_of(block.flags, first, count);
    part.values.reserve(count * channels);
    for (std::size_t channel = 0; channel < channels; ++channel) {
      const auto column = part_of(block.values, channel * block.samples + first, count);
      part.values.insert(part.values.end(), column.begin(), column.end());
    }
    part.received_utc_ns = block.received_utc_ns;
  }
  return parts;
}

} // namespace dyncal::inline stream
