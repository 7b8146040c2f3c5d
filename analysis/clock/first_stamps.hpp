// What the first samples of a source tell of how its stamps are made. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/clock/tick_line.hpp"

namespace dyncal::analysis {

struct TimedSample {
  std::uint64_t number = 0;
  std::int64_t stamp_ns = 0;
  bool begins_stretch = false; // has no interval to the one before
};

// The one interval of nine in ten, of which all others are multiples; empty where there is none.
[[nodiscard]] std::optional<std::int64_t> alike_interval_ns(std::span<const TimedSample> first);

struct FirstTicks {
  std::int64_t tick_ns = 0; // that all distances are multiples of
  TickLine line;            // of those samples that lie on one
};

// Ticks of more than a quarter of the usual interval, where at least 32 samples in a row lie on a
// line of such ticks; empty otherwise.
[[nodiscard]] std::optional<FirstTicks> ticks_of(std::span<const TimedSample> first);

struct FirstPeriod {
  double period_ns = 0.0;
  double scatter_ns = 0.0;
  std::int64_t tick_ns = 0;
  double coarse_tick_ns = 0.0; // 0: none
};

// Empty where the intervals are not periods in nine of ten cases, or not most of the time.
[[nodiscard]] std::optional<FirstPeriod> period_of(std::span<const TimedSample> first);

// What a distance may be off a multiple of the period: a quarter of it and a coarse tick, at most
// three quarters (a whole period is a missing sample).
[[nodiscard]] double period_margin_ns(double period_ns, double coarse_tick_ns);
[[nodiscard]] bool is_multiple(double distance_ns, double period_ns, double margin_ns);

} // namespace dyncal::analysis
