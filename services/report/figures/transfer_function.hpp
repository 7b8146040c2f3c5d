// The complex transfer function as a picture: magnitude above, phase below, over frequency on a
// logarithmic axis, every repetition with a marker of its own, the mean as a line with error bars
// of one standard uncertainty, and the low frequencies enlarged where the plot has room (figure 5
// of the paper).
//
// Means with a flag have a ring around them, and the legend below the panels explains each flag.
//
// Phase is lead in radians (ISO 2041): a delay has negative phase and falls with frequency.
// Repetitions may be given in (-pi, pi]; they are drawn in the turn of the mean at the same
// frequency.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/response/comparison.hpp"
#include "analysis/response/group_delay.hpp"
#include "services/report/figures/figure.hpp"

namespace dyncal::services::figures {

struct ValueOverFrequency {
  double frequency_hz = 0.0;
  analysis::ComparedResult value{}; // with standard uncertainties
  std::string flags{};              // names, separated by spaces
};

struct RepetitionPoint {
  std::uint32_t repetition = 0;
  ValueOverFrequency point{};
};

struct TransferFunctionData {
  std::string title{};    // e.g. "acc-1: dau/acceleration_z"
  std::string subtitle{}; // e.g. run and date; may be empty
  std::string unit{};     // of the magnitude; "1" for none, empty: not known
  std::vector<RepetitionPoint> repetitions{};
  std::vector<ValueOverFrequency> mean{}; // unwrapped phase
  std::optional<analysis::GroupDelay> group_delay{};
  std::vector<std::string> legend{}; // one sentence for each flag, below the panels
};

[[nodiscard]] Figure transfer_function_figure(const TransferFunctionData& data,
                                              const std::string& name);

} // namespace dyncal::services::figures
