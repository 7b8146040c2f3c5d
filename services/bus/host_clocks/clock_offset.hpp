// The offset of another host's clock, from requests to it and its answers, as NTP does it.
//
// A request is sent at t1 and its answer received at t4 by our clock; it was received at t2 and
// answered at t3 by the other one. The other clock is ahead of ours by
//   offset = ((t2 - t1) + (t3 - t4)) / 2,
// and whatever the two directions took, the truth is within bound = ((t4 - t1) - (t3 - t2)) / 2 of
// it: half the time on the way. Of the last exchanges the one with the smallest bound counts; the
// bound of an older one grows by `max_drift`, what two clocks may have moved since. An exchange
// that contradicts older ones shows that a clock was set: those are forgotten.
//
// Plain data, one thread.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "services/bus/clock.hpp"

namespace dyncal::inline host_clocks {

struct ClockStamps { // UTC
  std::int64_t request_sent_ns = 0;
  std::int64_t request_received_ns = 0;
  std::int64_t answer_sent_ns = 0;
  std::int64_t answer_received_ns = 0;
};

struct ClockOffset {
  double offset_s = 0.0; // positive: the other clock is ahead
  double bound_s = 0.0;  // the offset is within this of the truth
};

// People compare log lines of two hosts: from here on they no longer fit together.
inline constexpr double notable_offset_s = 1.0;

// The clocks are further apart than that, whatever the offset's bound.
[[nodiscard]] bool is_notable(const ClockOffset& clock);

// Nothing if the stamps cannot be of one exchange: one is before 1970, or the time on the way would
// be negative.
[[nodiscard]] std::optional<ClockOffset> clock_offset(const ClockStamps& stamps);

class OffsetTracker {
public:
  using Instant = bus::Clock::Instant;
  static constexpr std::size_t kept_exchanges = 8;
  static constexpr double max_drift = 1e-4; // s/s of two clocks against each other

  void add(const ClockStamps& stamps, Instant now);
  // Nothing before the first exchange.
  [[nodiscard]] std::optional<ClockOffset> offset(Instant now) const;

private:
  struct Exchange {
    ClockOffset offset;
    Instant time;
  };

  [[nodiscard]] static ClockOffset aged(const Exchange& exchange, Instant now);

  std::deque<Exchange> exchanges_; // the newest last
};

} // namespace dyncal::inline host_clocks
