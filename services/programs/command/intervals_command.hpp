// `dyncal intervals DATA.csv`: the sample clock of a recorded series by direct sample interval
// evaluation (paper section 3, analysis/clock/sample_clock.hpp): statistics, histogram, events.
// Belongs to one thread.
#pragma once

#include <filesystem>
#include <string>

namespace dyncal::inline programs {

struct IntervalsCommand {
  std::filesystem::path file;
  std::string temperature;      // column, "" for none
  double tick_s = 0.0;          // of the counter that made the stamps, 0: not known
  double nominal_rate_hz = 0.0; // 0: not known
  bool json = false;
};

[[nodiscard]] int run_intervals(const IntervalsCommand& command);

} // namespace dyncal::inline programs
