// The group delays of two results, channel by channel: what E_n says of their slopes of phase,
// which are known far better than a single phase.
//
// Left out are channels whose points are not the same in both, for a delay is that of its
// frequencies, and those where the phases lie on no line, or on that of another delay as well, and
// those of which neither U is above 0. Plain function, any thread.
#pragma once

#include <string>
#include <vector>

#include "analysis/response/comparison.hpp"
#include "services/views/report/paired_points.hpp"

namespace dyncal::inline views {

struct ComparedDelay {
  std::string channel;
  std::string other_channel;
  double delay_s = 0.0;
  double other_delay_s = 0.0;
  analysis::Difference difference; // s
};

[[nodiscard]] std::vector<ComparedDelay>
compare_delays(const StoredResult& first, const StoredResult& second, const PairedPoints& paired);

} // namespace dyncal::inline views
