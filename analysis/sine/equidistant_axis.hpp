// The time axis of samples that are equally spaced by any interval, for the fits, whose stamps are
// whole nanoseconds.
//
// The interval is stretched to the next whole nanosecond and the frequency shrunk in the same
// ratio, so that frequency times stamp, which is all that a fit sees, is exact for every interval.
// Frequencies that a fit on this axis reports are converted back by `hz()`. Stamps begin at 0. Any
// thread.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

class EquidistantAxis {
public:
  explicit EquidistantAxis(double interval_s)
      : interval_ns_(std::max<std::int64_t>(1, std::llround(interval_s * 1e9))),
        stretch_(static_cast<double>(interval_ns_) / (interval_s * 1e9)) {}

  [[nodiscard]] std::vector<std::int64_t> stamps_ns(std::size_t samples) const {
    std::vector<std::int64_t> stamps(samples);
    for (std::size_t i = 0; i < samples; ++i) {
      stamps[i] = static_cast<std::int64_t>(i) * interval_ns_;
    }
    return stamps;
  }
  [[nodiscard]] Frequency on_axis(double frequency_hz) const {
    return Frequency::from_hz(frequency_hz / stretch_);
  }
  [[nodiscard]] double hz(double frequency_on_axis_hz) const {
    return frequency_on_axis_hz * stretch_;
  }

private:
  std::int64_t interval_ns_;
  double stretch_;
};

} // namespace dyncal::analysis
