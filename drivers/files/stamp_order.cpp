#include "drivers/files/stamp_order.hpp"

namespace dyncal::drivers::files {
namespace {

constexpr unsigned rising_before_trust = 8;

} // namespace

std::uint8_t StampOrder::flag_of(std::int64_t stamp_ns) {
  const bool rises = !last_ns_ || stamp_ns > before_ns_;
  before_ns_ = stamp_ns;
  if (!last_ns_ || stamp_ns > *last_ns_) {
    last_ns_ = stamp_ns;
    behind_ = 0;
    return 0;
  }
  behind_ = rises ? behind_ + 1 : 1;
  if (behind_ > rising_before_trust) {
    last_ns_ = stamp_ns;
    behind_ = 0;
    return 0;
  }
  return stamp_ns == *last_ns_ ? stamp_repeated : stamp_backwards;
}

void StampOrder::check(SampleBlock& block) {
  for (std::size_t i = 0; i < block.stamps_ns.size(); ++i) {
    const std::uint8_t flag = flag_of(block.stamps_ns[i]);
    if (flag != 0) {
      block.flags.resize(block.samples, 0);
      block.flags[i] = flag;
    }
  }
}

} // namespace dyncal::drivers::files
