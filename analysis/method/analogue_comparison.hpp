// Transfer function when sensor and reference share one time base: paper eqs. (1), (2), in the
// project's convention.
//
//   H     = P_dut / P_ref e^{i w tau_ch}
//   |H|   = |P_dut| / |P_ref|
//   arg H = arg(P_dut conj(P_ref)) + w tau_ch
//
// tau_ch is the known extra delay of the sensor's channel against the reference's (0 for one
// digitiser). Eq. (2) as printed has arctan(B/A), wrong by pi for A < 0, and the sign that makes
// e^{-i phi} the conjugate (errata T2, T3); atan2 of the quotient is meant. Two cases:
//
//   analogue       both channels have the same stamps: evaluate_analogue
//   absolute time  two clocks on one time scale (GPS) stamp reference and sensor, without sync:
//                  evaluate_absolute_time
//
// The frequency is refined on the reference; in the analogue case on sync, where it is recorded on
// the same clock: it has the least noise, and the ratio hardly depends on it.
//
// In absolute time the frequency is refined on the reference and taken over, for both clocks run at
// the same rate; what is left of the clocks' offset goes into the phase in full, w u(offset) (150
// ns: 9.4 mrad at 10 kHz). Both records are evaluated about one instant, the middle of the
// reference's.
//
// Fails as channels_of_one_clock.hpp does. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/instrument/reference_calibration.hpp"
#include "analysis/method/step_findings.hpp"
#include "analysis/method/transfer_point.hpp"

namespace dyncal::analysis {

struct ComparisonUncertainty { // standard uncertainties that no residual shows
  double reference_magnitude_rel = 0.0;
  double reference_phase_rad = 0.0;
  double channel_delay_s = 0.0;  // u(tau_ch)
  double clock_offset_s = 0.0;   // absolute time: one clock against the other
  double stamp_jitter_s = 0.0;   // absolute time: white noise of the sensor's stamps
  double reference_tick_s = 0.0; // absolute time: quantum of the stamps, 0: none
  double dut_tick_s = 0.0;
};

struct AnalogueInput {
  Frequency frequency; // nominal
  double frequency_search_rel = 1e-3;
  std::span<const std::int64_t> stamps_ns{};
  ChannelSamples reference{};
  std::optional<ChannelSamples> sync{};
  std::vector<ChannelSamples> dut{};
  double channel_delay_s = 0.0; // tau_ch
  ReferenceResponse reference_response{};
  ComparisonUncertainty systematic{};
};

struct AbsoluteTimeInput {
  Frequency frequency;
  double frequency_search_rel = 1e-3;
  std::span<const std::int64_t> reference_stamps_ns{};
  ChannelSamples reference{};
  std::span<const std::int64_t> dut_stamps_ns{};
  std::vector<ChannelSamples> dut{};
  double channel_delay_s = 0.0;
  ReferenceResponse reference_response{};
  ComparisonUncertainty systematic{};
};

struct ComparisonResult {
  ChannelFit reference;
  std::optional<ChannelFit> sync;
  std::vector<TransferPoint> points; // in the order of `dut`
  StepFindings findings{};
};

[[nodiscard]] Expected<ComparisonResult> evaluate_analogue(const AnalogueInput& input);
[[nodiscard]] Expected<ComparisonResult> evaluate_absolute_time(const AbsoluteTimeInput& input);

} // namespace dyncal::analysis
