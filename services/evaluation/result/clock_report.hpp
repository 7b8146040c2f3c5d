// What a run tells of the sample clock of its sensor. Of series time stamping, whose samples have
// no stamps, the rate is known and `clock.intervals` is 0. A NaN `clock.u_mean_interval_s`: nothing
// is known of it, as of a clock of the source's own, whose rate nobody states. Plain data; any
// thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/clock/sample_clock.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::inline evaluation {

// A block of a source.
struct BlockPosition {
  std::uint64_t session = 0;
  std::uint64_t number = 0;
  bool operator==(const BlockPosition&) const = default;
};

struct ClockReport {
  std::string source;
  analysis::SampleClockStatistics clock;
  std::vector<Flag> flags{};
  std::optional<BlockPosition> last_block{}; // that it covers
};

} // namespace dyncal::inline evaluation
