// The response of the DAU's sync ADC from one excitation step: the same sine recorded by the DAU
// and by an analogue system, with the stamps and sampling instants that calibrations use.
//
//   G = P_dau(t) / P_acs(t),   P(t) = P(t_0) e^{i w (t - t_0)},   gain = |G|,   phase lag = -arg G
//
// t is one instant of ONE time scale in which both systems stamp (UTC, say), t_0 the phase origin
// of each. A sine that both record links two unrelated clocks only up to a delay, and a delay is
// what an ADC's phase is made of; an event within the sync signal does not help, for it comes
// through the same ADC. What brings in the time scale must reach the DAU past its ADC, as the
// pulses of a GPS receiver do. Both phasors are taken to the middle of their phase origins, each at
// its own frequency. The lag contains the instant of sampling after the stamp (data-ready to
// conversion): that belongs to the correction.
//
// Uncertainty of this step: fits, and their frequencies over the way to t. Common to steps: w
// u_time_scale, and the analogue system's sync channel, whose delay and gain are known within their
// uncertainties.
//
// Fails: invalid_argument (a phasor without amplitude or frequency, or phase origins further apart
// than `max_apart_s`: not one time scale, or not one step). Any thread.
#pragma once

#include <cstdint>

#include "analysis/base/error.hpp"
#include "analysis/instrument/adc_calibration.hpp"

namespace dyncal::analysis {

struct SyncPhasor { // one system's sine approximation of sync
  double frequency_hz = 0.0;
  double u_frequency_hz = 0.0;
  std::int64_t phase_origin_ns = 0; // on the common time scale
  double sine = 0.0;
  double cosine = 0.0;
  double u_sine = 0.0;
  double u_cosine = 0.0;
};

struct AdcComparisonUncertainty { // standard uncertainties, common to all steps
  double time_scale_s = 0.0;      // of the two systems' stamps against each other
  double acs_delay_s = 0.0;       // of the analogue system's sync channel
  double acs_gain_rel = 0.0;
};

struct AdcComparison {
  AdcCalibrationPoint
      point; // u_ fields: common part, as adc_calibration_points() wants it of measurements
  double noise_gain = 0.0; // standard uncertainty of this step alone
  double noise_phase_rad = 0.0;
  double sync_vpp = 0.0; // as the analogue system saw it
};

[[nodiscard]] Expected<AdcComparison> compare_sync_adc(const SyncPhasor& acs, const SyncPhasor& dau,
                                                       double max_apart_s,
                                                       const AdcComparisonUncertainty& uncertainty);

} // namespace dyncal::analysis
