#include "drivers/files/regular_stamps.hpp"

namespace dyncal::drivers::files {

void make_regular(SampleBlock& block) {
  if (block.samples < 2 || !block.flags.empty()) {
    return;
  }
  const std::int64_t interval = block.stamps_ns[1] - block.stamps_ns[0];
  if (interval <= 0) {
    return;
  }
  for (std::size_t i = 2; i < block.samples; ++i) {
    if (block.stamps_ns[i] - block.stamps_ns[i - 1] != interval) {
      return;
    }
  }
  std::int64_t since_origin = 0;
  std::int64_t origin = 0;
  if (__builtin_mul_overflow(block.first_sample, interval, &since_origin) ||
      __builtin_sub_overflow(block.stamps_ns[0], since_origin, &origin)) {
    return;
  }
  block.clock = RegularClock{origin, interval, 1};
  block.stamps_ns.clear();
}

std::string not_rising(std::uint64_t sample, std::uint64_t before) {
  return "sample_number " + std::to_string(sample) + " after " + std::to_string(before) +
         "; it must rise";
}

} // namespace dyncal::drivers::files
