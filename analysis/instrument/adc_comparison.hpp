// The response of the DAU's sync ADC from one excitation step: the same sine recorded by the DAU
// and by an analogue system, in the data-ready path, that is with the stamps and the sampling
// instants that calibrations use.
//
//   G = P_dau(t) / P_acs(t),   P(t) = P(t_ref) e^{i w (t - t_ref)},   gain = |G|,   phase lag =
//   -arg G
//
// t is one instant of ONE time scale in which both systems stamp (UTC, say). This cannot be done
// without: a sine that both record links two unrelated clocks only up to a delay, and a delay is
// what an ADC's phase is made of; nor does an event within the sync signal help, for it comes
// through the same ADC. What brings in the time scale must reach the DAU past its ADC, as the
// pulses of a GPS receiver do. The phasors are taken to the instant in the middle of their own
// reference instants, each at its own frequency. The lag contains the instant of sampling after the
// stamp (data-ready to conversion): that belongs to the correction. Uncertainty, noise of this
// step: fits, and their frequencies over the way to t. Common to steps: w u_time_scale and the
// analogue system's own sync channel: its delay and its gain are taken as known within their
// uncertainties. Fails: invalid_argument (a phasor without amplitude or frequency, or reference
// instants further apart than `max_apart_s`: then they are not on one time scale, or not of one
// step). Any thread.
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
