// The result of one channel in one step of a run: the value of its transfer function, the budget
// behind it, and what it was made of.
//
// Phase is lead in rad, within (-pi, pi] (a delay is negative); u_ is a standard uncertainty (k =
// 1). A result that is not valid has no numbers (NaN) and names the reason in `problem`. Plain
// data; any thread.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "analysis/method/clock_link.hpp"
#include "analysis/method/nominal_frequency.hpp"
#include "analysis/method/start_latency.hpp"
#include "analysis/method/step_findings.hpp"
#include "analysis/method/transfer_check.hpp"
#include "analysis/method/transfer_point.hpp"
#include "analysis/step/peak_shape.hpp"
#include "services/evaluation/result/channel_lines.hpp"
#include "services/evaluation/result/channel_signal.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::inline evaluation {

// What one source contributed.
struct SourceSamples {
  std::string source;
  std::uint64_t used = 0;
  std::uint64_t lost = 0;          // did not come
  std::uint64_t unusable = 0;      // came in a block or record that could not be used
  std::uint64_t overflowed = 0;    // dropped by a full buffer before they were evaluated
  std::uint64_t not_trusted = 0;   // left out for their stamp
  std::uint64_t not_measured = 0;  // left out, for the device measured no value
  std::int64_t first_stamp_ns = 0; // of the samples used, in the source's own clock
  std::int64_t last_stamp_ns = 0;
  std::uint64_t cut_out = 0; // left out for a disturbance

  [[nodiscard]] std::uint64_t all_lost() const { return lost + unusable + overflowed; }
};

// What the series of a sensor tell of its clock and its start.
struct SeriesFinding {
  double sample_rate_hz = 0.0;
  double u_sample_rate_hz = 0.0;
  std::string start; // as to_string(StartKind) gives it
  double start_scatter_s = 0.0;
};

struct StepResult {
  static constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

  std::string channel; // "source/channel"
  std::uint32_t step = 0;
  std::uint32_t repetition = 0;
  std::uint32_t attempt = 1; // the excitation of the step that it is of
  std::string frequency_text_hz;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;  // as planned
  std::string excited_axis; // empty: not stated
  bool valid = false;
  std::string problem;
  double magnitude = nan_value;
  double u_magnitude = nan_value;
  double phase_rad = nan_value;
  double u_phase_rad = nan_value;
  std::string unit; // D-SI, output per input
  std::vector<analysis::ChannelFit> fits;
  std::vector<analysis::Contribution> budget;
  std::vector<ChannelSignal> signals; // of reference, syncs and the channel
  std::vector<SourceSamples> samples;
  std::uint64_t lost = 0; // all that was lost of any source
  std::vector<Flag> flags;
  std::string data_sha256;
  std::optional<double> temperature_degc; // mean of the recipe's channel during the step
  std::optional<SeriesFinding> series;    // series time stamping
  std::optional<analysis::TransferCheck> monte_carlo;
  // Lines beside the excitation are flagged, and settled at the end of the run (line_bounds.hpp).
  bool provisional = false;
  // For that, within the evaluation: no message has them.
  std::vector<ChannelLines> lines;
  std::optional<analysis::RatioChange> change; // that flag changed_within_step tells of
  std::optional<analysis::BentPeaks> peaks;    // found or not
  std::optional<analysis::ClockLink> clock_link;
};

} // namespace dyncal::inline evaluation
