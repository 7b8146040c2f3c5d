// A channel of a sensor whose samples have stamps of their own, on the time scale of the record
// that links it to the reference:
//
//   H = P_dut link e^{-2 pi i f (t_dut - t_pilot)}
//
// The pilot is what that time scale has of the excitation: sync beside the sensor, or the reference
// where all clocks are on UTC. Its frequency holds for the sensor too; t_pilot and t_dut are the
// middles of the two records, subtracted in whole nanoseconds. The budget takes the sensor's noise
// and quantisation, jitter of its stamps, the frequency's uncertainty over the distance of the
// middles, and the uncertainty of one clock against the other in full: w u(offset). Its ratio to
// the reference is looked at in blocks (ratio_blocks.hpp).
//
// Fails as channels_of_one_clock.hpp does. Any thread.
#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <span>

#include "analysis/base/error.hpp"
#include "analysis/clock/stamp_beat.hpp"
#include "analysis/method/channels_of_one_clock.hpp"
#include "analysis/method/step_findings.hpp"
#include "analysis/method/transfer_point.hpp"
#include "analysis/uncertainty/budget.hpp"
#include "analysis/uncertainty/ratio_blocks.hpp"

namespace dyncal::analysis {

// What the sensor is linked to.
struct OwnClockLink {
  std::complex<double> link;
  const Budget& noise; // rows of the channels that all sensors share
  const Budget& systematic;
  const RecordedChannel& reference;
  // In blocks, where they are known: sync on the pilot's time scale, and the reference.
  const std::optional<BlockSeries>& sync;
  const std::optional<BlockSeries>& denominator;
  BlockAlignment alignment{}; // of the pilot's time scale to the denominator's
  bool noise_unknown = false; // of one of these channels
};

struct OwnClockUncertainty { // standard uncertainties
  double clock_offset_s = 0.0;
  double stamp_jitter_s = 0.0; // white noise of the sensor's stamps
  StampBeat stamp_beat{};      // bounds: of errors of these that are in step with the signal
};

// What it finds along the step is added to `findings`.
[[nodiscard]] Expected<TransferPoint>
evaluate_own_clock_channel(const ChannelFit& pilot, std::int64_t pilot_first_ns,
                           const OwnClockLink& link, std::span<const std::int64_t> dut_stamps_ns,
                           const ChannelSamples& dut, const OwnClockUncertainty& clock,
                           StepFindings& findings);

} // namespace dyncal::analysis
