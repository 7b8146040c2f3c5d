// How far a run is, for whoever shows it. Plain data, any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace dyncal::inline run {

struct RunProgress {
  std::size_t step = 0; // 1..steps; 0 before the first
  std::size_t steps = 0;
  std::uint32_t attempt = 1; // at this step
  std::string frequency_hz;
  std::string phase;   // "waiting for the analysis", "settling", "measuring", ...
  std::string request; // to the operator; "" for none
  std::string notice;  // what has happened, for a line of its own; "" for none
  std::size_t results = 0;
  std::optional<double> seconds_left; // of the host's clock
};

using ShowProgress = std::function<void(const RunProgress&)>;

} // namespace dyncal::inline run
