// Sample time stamping: the complex transfer function of a digital output sensor from the four
// channels of one excitation step, paper eqs. (3) and (4), in the project's convention
//
//   H = (P_dos / P_ref) U(P_sync_acs) / U(P_sync_dau,true),   U(z) = z / |z|,   H = |H| e^{i psi}
//   arg P_sync_dau,true = arg P_sync_dau - arg G,             G = gain e^{-i phase_lag}
//
// psi is lead (a delay is negative); the paper's dphi of eq. (4) is -psi, and S = |S| e^{-i dphi} =
// H (errata T1-T5). G is the response of the DAU's sync ADC; its amplitude must not enter |H|. A
// known delay of the reference's channel against the ACS's sync is taken out: arg P_ref + w
// tau_ref. Its calibrated response R is taken out, P_ref / R (reference_calibration.hpp).
//
// In each system the frequency is refined on its sync channel in that system's own clock, and both
// of its channels are evaluated at that frequency about the same instant, which removes unknown
// epochs and constant rate errors. Significant harmonics and hum are fitted beside the signal
// (disturbances.hpp). The ratio of sensor and reference is looked at in blocks, so that what both
// share cancels, and what else makes the residuals other than white has a row of its own
// (ratio_blocks.hpp); for that the two records begin at most a frame of the search apart.
//
// Fails as sine_fit.hpp does; the message names the channel. no_excitation when reference or sync
// is not significant; a channel under calibration may be without excitation, its phase then has an
// uncertainty up to pi / sqrt(3). Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/instrument/adc_calibration.hpp"
#include "analysis/instrument/reference_calibration.hpp"
#include "analysis/method/step_findings.hpp"
#include "analysis/method/transfer_point.hpp"

namespace dyncal::analysis {

struct SystematicUncertainty { // standard uncertainties that no residual shows
  double reference_magnitude_rel = 0.0;
  double reference_phase_rad = 0.0;
  double acs_delay_s = 0.0;       // residual delay between the ACS channels
  double dau_jitter_s = 0.0;      // white stamp noise common to sync and DOS (tick included)
  double dau_tick_s = 0.0;        // quantum of the DAU's stamps, 0: none
  double sync_adc_jitter_s = 0.0; // scatter of the instant at which the DAU's ADC samples sync,
                                  // which its stamp does not show
  double clock_offset_s = 0.0;    // of a sensor with stamps of its own: its clock against the DAU's
  double dut_tick_s = 0.0;        // quantum of these stamps, 0: none
};

struct SampleStampingInput {
  Frequency frequency; // nominal
  double frequency_search_rel =
      1e-3; // 0: the frequency is known exactly in both clocks and not refined
  std::span<const std::int64_t> acs_stamps_ns{};
  ChannelSamples reference{};
  ChannelSamples sync_acs{};
  std::span<const std::int64_t> dau_stamps_ns{};
  ChannelSamples sync_dau{};
  std::vector<ChannelSamples> dut{}; // one result each
  // Empty: the sensor has the stamps of the DAU. Otherwise it is stamped beside the DAU that
  // records sync, on the same time scale (own_clock_channel.hpp), with `clock_offset_s` between the
  // two.
  std::span<const std::int64_t> dut_stamps_ns{};
  AdcResponse adc{};
  double reference_delay_s = 0.0; // tau_ref
  ReferenceResponse reference_response{};
  SystematicUncertainty systematic{};
  // Where both clocks have UTC: standard uncertainty between them. Then their stamps link them
  // beside sync (clock_link.hpp).
  std::optional<double> u_utc_s{};
};

struct SampleStampingResult {
  ChannelFit reference;
  ChannelFit sync_acs;
  ChannelFit sync_dau;
  std::vector<TransferPoint> points; // in the order of `dut`
  StepFindings findings{};
};

[[nodiscard]] Expected<SampleStampingResult>
evaluate_sample_stamping(const SampleStampingInput& input);

} // namespace dyncal::analysis
