// The deviation of a DAU's time stamps from a reference pulse as a picture (figure 2 of the paper):
// over the time of the record, how it is distributed, and its Allan deviation. The CSV holds every
// deviation.
#pragma once

#include <string>
#include <vector>

#include "analysis/instrument/stamp_deviation.hpp"
#include "services/views/figures/figure.hpp"

namespace dyncal::inline views::figures {

struct StampDeviationData {
  std::string title{};
  std::string subtitle{};
  std::vector<std::string> comments{}; // of the CSV
  double tick_s =
      0; // of the counter; 0: not known. A bin of the histogram is a whole number of ticks.
  std::vector<analysis::StampDeviation> deviations{};
  std::vector<analysis::AllanPoint> allan{}; // may be empty: the panel is left out
};

[[nodiscard]] Figure stamp_deviation_figure(const StampDeviationData& data,
                                            const std::string& name);

} // namespace dyncal::inline views::figures
