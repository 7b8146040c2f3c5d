// The complex transfer function as a picture: magnitude above, phase below, over frequency on a
// logarithmic axis, every repetition with a marker of its own, the mean as a line with error bars
// of one standard uncertainty, and the low frequencies enlarged where the plot has room (figure 5
// of the paper).
//
// Phase is lead in radians (ISO 2041): a delay has negative phase and falls with frequency.
// Repetitions may be given in (-pi, pi]; they are drawn in the turn of the mean at the same
// frequency.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/report/figures/figure.hpp"

namespace dyncal::services::figures {

struct TransferPoint {
  double frequency_hz;
  double magnitude;
  double u_magnitude; // standard uncertainty, in the unit of the magnitude
  double phase_rad;
  double u_phase_rad;
};

struct RepetitionPoint {
  std::uint32_t repetition;
  TransferPoint point;
};

struct GroupDelay {
  double value_s;
  double u_s;
  double intercept_rad; // of the line: phase = intercept - 2 pi frequency delay
};

struct TransferFunctionData {
  std::string title{};    // e.g. "acc-1: dau/acceleration_z"
  std::string subtitle{}; // e.g. run and date; may be empty
  std::string unit{};     // of the magnitude; empty or "1" for none
  std::vector<RepetitionPoint> repetitions{};
  std::vector<TransferPoint> mean{}; // unwrapped phase
  std::optional<GroupDelay> group_delay{};
};

[[nodiscard]] Figure transfer_function_figure(const TransferFunctionData& data,
                                              const std::string& name);

} // namespace dyncal::services::figures
