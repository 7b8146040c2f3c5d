// What goes into an evaluation and what comes out of it, the same for every method: recorded
// channels, fitted sines, one value of the transfer function with its uncertainty budget.
//
// H = |H| e^{i psi}, psi lead in radians, a delay is negative. All u_ are standard uncertainties.
// Plain data, any thread.
#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "analysis/interferometer/interferometer_budget.hpp"
#include "analysis/interferometer/reference_motion.hpp"
#include "analysis/sine/mains.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "analysis/sine/stamp_scatter.hpp"
#include "analysis/step/signal_integrity.hpp"
#include "analysis/step/sine_onset.hpp"
#include "analysis/uncertainty/contribution.hpp"

namespace dyncal::analysis {

// Of a reference: the quantity that it measures, and the one that the response is per. Displacement
// and velocity are taken without the slow motion of the table (reference_motion.hpp).
struct ReferenceQuantity {
  MotionQuantity measured = MotionQuantity::acceleration;
  MotionQuantity per = MotionQuantity::acceleration;
  std::optional<InterferometerErrors> interferometer{}; // of a displacement that one measured
};

struct ChannelSamples {
  std::string name;
  std::span<const double> values;
  double resolution = 0.0; // one quantisation step; 0: not stated
  // What its integrity is held against; a resolution that is not stated is found in the values.
  SignalExpectation expected{};
  std::span<const double> mains_hz = usual_mains_hz; // lines that are looked for beside the sine
  RisingSine rise{}; // of the same channel, before these samples; empty where it is not known
  std::optional<ReferenceQuantity> motion{}; // empty: another quantity, or none of a reference
};

struct ChannelFit { // the sine fitted to one recorded channel
  std::string channel;
  Frequency frequency;
  double u_frequency_hz = 0.0;
  std::int64_t phase_origin_ns = 0;
  SineFit fit;
  // Of the samples as they came; empty where the channel is without excitation.
  std::optional<SignalIntegrity> integrity{};
  StampScatter scatter{}; // of its stamps, as its residuals show it; `fit` is without correction
};

struct TransferPoint {
  std::string channel{};
  std::complex<double> h{};
  double magnitude = 0.0;
  double u_magnitude = 0.0;
  double phase_rad = 0.0; // (-pi, pi]
  double u_phase_rad = 0.0;
  std::vector<Contribution> budget{};
  ChannelFit dut;
};

} // namespace dyncal::analysis
