// What a run tells of the sample clock of its sensor. Of series time stamping, whose samples have
// no stamps, the rate is known and `clock.intervals` is 0. Plain data; any thread.
#pragma once

#include <string>

#include "analysis/clock/sample_clock.hpp"

namespace dyncal::services {

struct ClockReport {
  std::string source;
  analysis::SampleClockStatistics clock;
};

} // namespace dyncal::services
