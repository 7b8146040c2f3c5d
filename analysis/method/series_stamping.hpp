// Series time stamping: the transfer function of a sensor that records a whole series after one
// trigger (TSS), paper section 2.4, in the project's convention (phases lead, theta = atan2(B, A)):
//
//   |H_j|   = A_TSS,j / A_ref                                                               (5)
//   arg H_j = theta_TSS,j(n = 0) - w (tau_DSO + l) - beta_j - (theta_ref - theta_sync)_ACS  (7)
//
// In shot j the oscilloscope records sync(u) = sin(w u + beta_j), u = 0 at its trigger point;
// beta_j is what the noise of the trigger did. The trigger edge leaves tau_DSO later, and sample 0
// is taken l after the edge. In the paper's lags the delay term has a plus, and e^{-i dphi} of (8)
// would be the conjugate (errata T7).
//
// The sensor's samples lie on the time axis of its nominal rate; all shots share one apparent
// frequency w_TSS, and (6) gives the real rate f_nom w / w_TSS. At n = 0 the rate needs no
// correction (paper section 2.5), but an error of w_TSS turns theta_0 of all shots alike by
// u(w_TSS) T / 2. Harmonics and hum are fitted beside the signal (disturbances.hpp); the shots are
// compared with each other and looked into (series_blocks.hpp), beta_j is trigger_phase.hpp's. When
// the series begin, l, is start_latency.hpp's: apply_start(). A trace is fitted best in its middle,
// t_m from the trigger point: an error of the rate of the oscilloscope's clock turns beta_j of all
// shots alike by w t_m u(rate). Mean over shots as in repetitions.hpp, which keeps the magnitude of
// shots whose phase scatters; tau_DSO and mean l are common to all shots and frequencies. The first
// of `channels` must be excited.
//
// Fails as channels_of_one_clock.hpp and sine_fit.hpp do; invalid_argument (no shot, shots of
// unequal length). Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/instrument/reference_calibration.hpp"
#include "analysis/method/nominal_frequency.hpp"
#include "analysis/method/repetitions.hpp"
#include "analysis/method/series_blocks.hpp"
#include "analysis/method/start_latency.hpp"
#include "analysis/method/transfer_point.hpp"

namespace dyncal::analysis {

struct SeriesShot {
  double dso_first_s = 0.0; // of the trace's first sample, 0 at the trigger point
  double dso_interval_s = 0.0;
  std::span<const double> dso_sync{};
  std::vector<std::span<const double>> series{}; // one per channel of the sensor, all of one length
};

struct SeriesStampingInput {
  Frequency frequency; // nominal
  double frequency_search_rel = 1e-3;
  std::span<const std::int64_t> acs_stamps_ns{};
  ChannelSamples reference{};
  ChannelSamples sync_acs{};
  std::vector<std::string> channels{};
  double nominal_rate_hz = 0.0; // of the TSS
  double rate_tolerance_rel = 0.05;
  std::vector<SeriesShot> shots{};
  double dso_delay_s = 0.0; // tau_DSO
  double u_dso_delay_s = 0.0;
  double u_dso_rate_rel = 0.0;  // of the oscilloscope's clock
  double start_latency_s = 0.0; // l
  double u_start_latency_s = 0.0;
  double start_scatter_s =
      0.0; // standard deviation of l from shot to shot, as far as it is known beforehand
  double reference_magnitude_rel = 0.0;
  double reference_phase_rad = 0.0;
  ReferenceResponse reference_response{};
  double acs_delay_s = 0.0;
  double reference_delay_s =
      0.0; // known delay of the reference's channel against the ACS's sync, taken out
  bool correct_trigger_phase =
      true; // false: beta_j is taken as 0, to see what the correction is worth
};

struct SeriesChannelResult {
  std::string channel;
  std::vector<Repetition> shots;
  RepetitionMean mean;
  std::vector<Contribution> common_budget;    // what all shots share
  std::optional<SeriesAgreement> agreement{}; // of the shots
};

struct SeriesStampingResult {
  ChannelFit reference;
  ChannelFit sync_acs;
  std::vector<double> trigger_phase_rad; // beta_j
  std::vector<double> u_trigger_phase_rad;
  NominalFrequency rate;
  std::vector<SeriesChannelResult> channels;
};

[[nodiscard]] Expected<SeriesStampingResult>
evaluate_series_stamping(const SeriesStampingInput& input);

// Corrects the mean latency that was found, and gives its uncertainty and scatter to all channels.
// `sample_s`: the real sample interval. Fails as repetitions.hpp does.
[[nodiscard]] Expected<void> apply_start(const StartLatency& start, double sample_s,
                                         double angular_hz, SeriesStampingResult& result);

} // namespace dyncal::analysis
