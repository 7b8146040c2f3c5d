// Sample time stamping of a multi-sine: the transfer function at all lines of one excitation, from
// the four channels that sample_stamping.hpp has for a step of one line.
//
// 1. The rate and the drift of either clock against the waveform, by all lines of its sync
//    (waveform_clock.hpp), leave the stamps: the lines have their nominal frequencies in both.
// 2. All lines of each record are fitted together (separated_lines.hpp).
// 3. One time tau links the clocks, by all lines of both syncs; the phase lag of the DAU's
//    converter is taken out. The DAU's stamps are then on the time scale of the ACS.
// 4. Each line, without the others, is evaluated as one sine on one time scale, eqs. (1), (2)
//    (analogue_comparison.hpp: absolute time), with its noise, hum and drift. Rows of its budget
//    beside those there: w u(tau) as clock offset; the converter's phase, by which tau is wrong if
//    the errors of all its lines are the same way round:
//
//      u_k = w_k sum_j g_j w_j u(lag_j) / sum_j g_j w_j^2,   g: weights of the link
//
//    jitter of the DAU's stamps and of its sync. Noise is what a fit leaves, without the products
//    of the lines (line_products.hpp), which fall on none of them; and what the lines beside it
//    show, that nobody excites, beyond that (neighbour_noise.hpp).
//
// Distortion is read from lines that nobody excites (line_products.hpp), end stops and stuck values
// from the whole signal (compound_integrity.hpp); both are the same for all lines of a channel.
//
// A line that the reference does not show, or that one channel under calibration does not, has an
// error in place of its value; the others go on. Fails for all of them as the parts named above do;
// the message names the channel. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/instrument/adc_calibration.hpp"
#include "analysis/instrument/reference_calibration.hpp"
#include "analysis/method/sample_stamping.hpp"
#include "analysis/method/step_findings.hpp"
#include "analysis/method/transfer_point.hpp"
#include "analysis/method/waveform_clock.hpp"
#include "analysis/method/waveform_link.hpp"

namespace dyncal::analysis {

struct ExcitedLine {
  Frequency frequency; // nominal
  AdcResponse adc{};
  ReferenceResponse reference_response{};
};

struct MultisineStampingInput {
  std::vector<ExcitedLine> lines; // two at least
  double period_s = 0.0;          // of the waveform
  double frequency_search_rel = 1e-3;
  std::span<const std::int64_t> acs_stamps_ns{};
  ChannelSamples reference{};
  ChannelSamples sync_acs{};
  std::span<const std::int64_t> dau_stamps_ns{};
  ChannelSamples sync_dau{};
  std::vector<ChannelSamples> dut{};
  double reference_delay_s = 0.0; // tau_ref
  SystematicUncertainty systematic{};
};

struct EvaluatedLine {
  ChannelFit reference;
  ChannelFit sync_acs;
  ChannelFit sync_dau;
  std::vector<TransferPoint> points; // in the order of `dut`
  StepFindings findings{};
};

struct MultisineStampingResult {
  std::vector<Expected<EvaluatedLine>> lines; // in the order of the input
  WaveformClock acs;
  WaveformClock dau;
  WaveformLink link;
  // What the lines leave of each channel, with its offset: reference, sync of the ACS, sync of the
  // DAU, then `dut`.
  std::vector<std::vector<double>> rests;
};

[[nodiscard]] Expected<MultisineStampingResult>
evaluate_multisine_stamping(const MultisineStampingInput& input);

} // namespace dyncal::analysis
