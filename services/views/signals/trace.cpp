#include "services/views/signals/trace.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace dyncal::inline views {
namespace {

constexpr double second_ns = 1e9;

class Columns {
public:
  Columns(std::int64_t begin_ns, double seconds, std::size_t count)
      : begin_ns_(begin_ns), width_s_(seconds / static_cast<double>(count)), last_(count - 1) {}

  void add(std::int64_t stamp_ns, double minimum, double maximum) {
    const double time_s = static_cast<double>(stamp_ns - begin_ns_) / second_ns;
    if (time_s < 0.0) {
      return;
    }
    const std::size_t place = std::min(last_, static_cast<std::size_t>(time_s / width_s_));
    if (columns_.empty() || place != place_) {
      columns_.push_back({time_s, minimum, maximum});
      place_ = place;
    } else {
      columns_.back().minimum = std::min(columns_.back().minimum, minimum);
      columns_.back().maximum = std::max(columns_.back().maximum, maximum);
    }
  }
  [[nodiscard]] std::vector<TraceColumn> take() { return std::move(columns_); }

private:
  std::int64_t begin_ns_;
  double width_s_;
  std::size_t last_;
  std::size_t place_ = 0;
  std::vector<TraceColumn> columns_;
};

// Of the newest second. In two passes, without a division for every sample.
void add_level(const ChannelRing& ring, const ChannelRange& range, Trace& trace) {
  const std::int64_t begin_ns = ring.newest_ns() - static_cast<std::int64_t>(second_ns);
  const auto newest = ring.samples().rbegin();
  const auto end = std::find_if(newest, ring.samples().rend(),
                                [&](const Sample& sample) { return sample.stamp_ns <= begin_ns; });
  const auto count = static_cast<double>(std::distance(newest, end));
  const double sum = std::accumulate(
      newest, end, 0.0, [](double so_far, const Sample& sample) { return so_far + sample.value; });
  const double mean = sum / count;
  double squares = 0.0;
  const bool has_range = range.minimum < range.maximum;
  for (auto sample = newest; sample != end; ++sample) {
    const double deviation = sample->value - mean;
    squares += deviation * deviation;
    const bool is_at_end = sample->value <= range.minimum || sample->value >= range.maximum;
    trace.over_range += has_range && is_at_end ? 1 : 0;
  }
  trace.level_rms = std::sqrt(squares / count);
}

} // namespace

Trace make_trace(const ChannelRing& ring, double seconds, std::size_t columns,
                 const ChannelRange& range) {
  Trace trace;
  if (ring.empty() || columns == 0) {
    return trace;
  }
  const std::int64_t begin_ns = ring.newest_ns() - std::llround(seconds * second_ns);
  Columns made(begin_ns, seconds, columns);
  const double width_ns = seconds * second_ns / static_cast<double>(columns);
  const bool by_samples = width_ns < 2.0 * static_cast<double>(ChannelRing::extremes_ns) &&
                          ring.samples().front().stamp_ns <= begin_ns;
  if (by_samples || ring.extremes().size() == ring.samples().size()) {
    for (const Sample& sample : ring.samples()) {
      made.add(sample.stamp_ns, sample.value, sample.value);
    }
  } else {
    for (const Extremes& one : ring.extremes()) {
      made.add(one.begin_ns, one.minimum, one.maximum);
    }
  }
  trace.columns = made.take();
  for (const TraceColumn& column : trace.columns) {
    trace.level_peak =
        std::max({trace.level_peak, std::abs(column.minimum), std::abs(column.maximum)});
  }
  trace.begin_utc_ns = ring.received_utc_ns() - std::llround(seconds * second_ns);
  trace.rate_hz = ring.rate_hz();
  add_level(ring, range, trace);
  const auto since_begin_s = [&](std::int64_t stamp_ns) {
    return static_cast<double>(stamp_ns - begin_ns) / second_ns;
  };
  for (const auto& [before_ns, after_ns] : ring.gaps()) {
    if (after_ns > begin_ns) {
      trace.gaps.emplace_back(since_begin_s(before_ns), since_begin_s(after_ns));
    }
  }
  return trace;
}

} // namespace dyncal::inline views
