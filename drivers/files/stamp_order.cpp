#include "drivers/files/stamp_order.hpp"

#include <algorithm>

namespace dyncal::drivers::files {
namespace {

constexpr unsigned rising_before_trust = 8;
constexpr std::uint64_t intervals_ahead = 8;
constexpr std::size_t looked_at_behind = 64;
constexpr std::uint64_t second_ns = 1'000'000'000;

// Of `later` above `earlier`: unsigned, so that it has room whatever a file says.
std::uint64_t distance_ns(std::int64_t earlier_ns, std::int64_t later_ns) {
  return static_cast<std::uint64_t>(later_ns) - static_cast<std::uint64_t>(earlier_ns);
}

bool is_longer(std::uint64_t distance_ns, std::uint64_t intervals, std::uint64_t interval_ns) {
  return distance_ns > 0 && (distance_ns - 1) / intervals >= interval_ns;
}

} // namespace

std::uint8_t StampOrder::flag_of(std::int64_t stamp_ns) {
  const bool rises = !last_ns_ || stamp_ns > before_ns_;
  before_ns_ = stamp_ns;
  if (!last_ns_ || stamp_ns > *last_ns_) {
    interval_ns_ = last_ns_ ? distance_ns(*last_ns_, stamp_ns) : 0;
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

std::size_t StampOrder::ahead(std::span<const std::int64_t> stamps_ns) const {
  if (!last_ns_ || interval_ns_ == 0 || stamps_ns.front() <= *last_ns_) {
    return 0;
  }
  const std::uint64_t first_ns = distance_ns(*last_ns_, stamps_ns.front());
  if (!is_longer(first_ns, intervals_ahead, interval_ns_)) {
    return 0;
  }
  const std::size_t looked_at = std::min(stamps_ns.size(), looked_at_behind + 1);
  for (std::size_t i = 1; i < looked_at; ++i) {
    // It comes back where it would be with as many intervals as samples, and is not a later one of
    // those that were set back.
    if (stamps_ns[i] > *last_ns_ && stamps_ns[i] < stamps_ns[i - 1] &&
        !is_longer(distance_ns(*last_ns_, stamps_ns[i]), 2 * (i + 1), interval_ns_)) {
      return i;
    }
  }
  const bool nothing_behind = stamps_ns.size() == 1;
  return nothing_behind && first_ns > second_ns ? 1 : 0;
}

void StampOrder::check(SampleBlock& block) {
  const std::span<const std::int64_t> stamps(block.stamps_ns);
  const auto set = [&block](std::size_t i, std::uint8_t flag) {
    block.flags.resize(block.samples, 0);
    block.flags[i] = flag;
  };
  for (std::size_t i = 0; i < stamps.size();) {
    const std::size_t wrong = ahead(stamps.subspan(i));
    for (std::size_t end = i + wrong; i < end; ++i) {
      set(i, stamps[i] > *last_ns_ && distance_ns(*last_ns_, stamps[i]) >= second_ns
                 ? stamp_second_slip
                 : stamp_offset_below_second);
    }
    if (wrong > 0) {
      continue;
    }
    if (const std::uint8_t flag = flag_of(stamps[i]); flag != 0) {
      set(i, flag);
    }
    ++i;
  }
}

} // namespace dyncal::drivers::files
