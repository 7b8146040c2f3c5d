#include "drivers/files/stamp_order.hpp"

#include <algorithm>

namespace dyncal::drivers::files {
namespace {

constexpr long double longest_interval_ns = 9.2e18L; // more is none
constexpr unsigned rising_before_trust = 8;
constexpr std::int64_t intervals_ahead = 8;
constexpr std::size_t looked_at_behind = 64;
constexpr std::int64_t second_ns = 1'000'000'000;

} // namespace

std::uint8_t StampOrder::flag_of(std::int64_t stamp_ns) {
  const bool rises = !last_ns_ || stamp_ns > before_ns_;
  before_ns_ = stamp_ns;
  if (!last_ns_ || stamp_ns > *last_ns_) {
    const auto interval_ns = last_ns_ ? static_cast<long double>(stamp_ns) - *last_ns_ : 0.0L;
    interval_ns_ = interval_ns < longest_interval_ns ? static_cast<std::int64_t>(interval_ns) : 0;
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
  if (!last_ns_ || interval_ns_ <= 0) {
    return 0;
  }
  // Exact for every stamp, and never beyond its range, whatever a file says.
  const auto from_last_ns = [&](std::int64_t stamp_ns) {
    return static_cast<long double>(stamp_ns) - static_cast<long double>(*last_ns_);
  };
  const auto interval_ns = static_cast<long double>(interval_ns_);
  if (from_last_ns(stamps_ns.front()) <= intervals_ahead * interval_ns) {
    return 0;
  }
  const std::size_t looked_at = std::min(stamps_ns.size(), looked_at_behind + 1);
  for (std::size_t i = 1; i < looked_at; ++i) {
    const long double back_ns = from_last_ns(stamps_ns[i]);
    // It comes back where it would be with as many intervals as samples, and is not a later one of
    // those that were set back.
    if (back_ns > 0.0L && back_ns <= 2.0L * static_cast<long double>(i + 1) * interval_ns &&
        stamps_ns[i] < stamps_ns[i - 1]) {
      return i;
    }
  }
  const bool nothing_behind = stamps_ns.size() == 1;
  return nothing_behind && from_last_ns(stamps_ns.front()) > second_ns ? 1 : 0;
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
      set(i, stamps[i] - *last_ns_ >= second_ns ? stamp_second_slip : stamp_offset_below_second);
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
