// A channel over the last seconds as columns of a picture: smallest and largest of each, so that
// the peak of a single sample stays, and its level.
//
//   rms    of the newest second, about its mean
//   peak   largest absolute value of the window
//
// Columns narrower than two milliseconds are made of samples, wider ones of the ring's
// milliseconds; a value then stands at the begin of its millisecond. Plain function; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "services/views/signals/channel_ring.hpp"

namespace dyncal::inline views {

struct TraceColumn {
  double time_s = 0.0; // of its first value, since the begin of the window
  double minimum = 0.0;
  double maximum = 0.0;
};

struct Trace {
  std::vector<TraceColumn> columns; // those without a value are left out
  std::int64_t begin_utc_ns = 0;    // of the window, by the host of the source
  double rate_hz = 0.0;
  double level_rms = 0.0;
  double level_peak = 0.0;
  std::size_t over_range = 0; // samples of the newest second at an end of the range
  std::vector<std::pair<double, double>> gaps; // in s since the begin
};

struct ChannelRange {
  double minimum = 0.0;
  double maximum = 0.0; // equal: not known
};

// Of an empty ring: no columns.
[[nodiscard]] Trace make_trace(const ChannelRing& ring, double seconds, std::size_t columns,
                               const ChannelRange& range);

} // namespace dyncal::inline views
