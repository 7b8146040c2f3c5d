#include "services/bus/host_clocks/clock_offset.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::inline host_clocks {
namespace {

// Of stamps since 1970 no difference overflows.
double difference_s(std::int64_t later_ns, std::int64_t earlier_ns) {
  return static_cast<double>(later_ns - earlier_ns) * 1e-9;
}

} // namespace

bool is_notable(const ClockOffset& clock) {
  return std::abs(clock.offset_s) - clock.bound_s > notable_offset_s;
}

std::optional<ClockOffset> clock_offset(const ClockStamps& stamps) {
  const bool since_1970 = stamps.request_sent_ns >= 0 && stamps.request_received_ns >= 0 &&
                          stamps.answer_sent_ns >= 0 && stamps.answer_received_ns >= 0;
  if (!since_1970 || stamps.answer_sent_ns < stamps.request_received_ns) {
    return std::nullopt;
  }
  const double there_s = difference_s(stamps.request_received_ns, stamps.request_sent_ns);
  const double back_s = difference_s(stamps.answer_sent_ns, stamps.answer_received_ns);
  const double bound_s = (difference_s(stamps.answer_received_ns, stamps.request_sent_ns) -
                          difference_s(stamps.answer_sent_ns, stamps.request_received_ns)) /
                         2.0;
  if (bound_s < 0.0) {
    return std::nullopt;
  }
  return ClockOffset{.offset_s = (there_s + back_s) / 2.0, .bound_s = bound_s};
}

ClockOffset OffsetTracker::aged(const Exchange& exchange, Instant now) {
  const double age_s = std::chrono::duration<double>(now - exchange.time).count();
  return {exchange.offset.offset_s, exchange.offset.bound_s + max_drift * std::max(age_s, 0.0)};
}

void OffsetTracker::add(const ClockStamps& stamps, Instant now) {
  const auto newest = clock_offset(stamps);
  if (!newest) {
    return;
  }
  std::erase_if(exchanges_, [&](const Exchange& exchange) {
    const ClockOffset older = aged(exchange, now);
    return std::abs(older.offset_s - newest->offset_s) > older.bound_s + newest->bound_s;
  });
  exchanges_.push_back({*newest, now});
  if (exchanges_.size() > kept_exchanges) {
    exchanges_.pop_front();
  }
}

std::optional<ClockOffset> OffsetTracker::offset(Instant now) const {
  std::optional<ClockOffset> best;
  for (const Exchange& exchange : exchanges_) {
    const ClockOffset offset = aged(exchange, now);
    if (!best || offset.bound_s < best->bound_s) {
      best = offset;
    }
  }
  return best;
}

} // namespace dyncal::inline host_clocks
