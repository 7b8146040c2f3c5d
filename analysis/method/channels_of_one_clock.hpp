// The channels that one clock recorded during a step, and what their sine approximation says: the
// common part of all methods.
//
// The frequency is refined on the pilot channel (sync, or the reference where there is no sync) in
// this clock and serves all channels, about the same instant, the middle of the record. Significant
// harmonics and hum (of the mains that the pilot names) are fitted beside the signal
// (disturbances.hpp). Rows of the budget:
//
//   fit noise     covariance of the fit without the share of white stamp noise s_t, which has rows
//                 of its own: w^2 A^2 s_t^2 / 2 of s^2
//   quantisation  quantisation.hpp, where the noise does not hide the steps; where nobody stated
//                 them, they are looked for in the values (found_resolution.hpp)
//   stamp jitter  what scatter of the stamps took off the amplitude, where its residuals show it
//                 (stamp_scatter.hpp), is put back, and its uncertainty is a row
//   motion        displacement and velocity of a reference are fitted without the slow motion of
//   the
//                 table (motion_channel.hpp), in the unit that they have
//   Rice          u^2 / (2 A^2), how much noise alone lengthens a weak phasor (below 10 u); its
//                 phase is that of phasor.hpp
//
// Fails as sine_fit.hpp does; no_excitation when the pilot is not 8 u above the noise; the message
// names the channel. Any thread.
#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/instrument/reference_calibration.hpp"
#include "analysis/method/transfer_point.hpp"
#include "analysis/step/short_disturbance.hpp"
#include "analysis/uncertainty/budget.hpp"

namespace dyncal::analysis {

struct RecordedChannel {
  ChannelFit result;
  std::vector<double> cleaned; // the samples without disturbances, where some were found
  ChannelSamples samples;
  std::span<const std::int64_t> stamps_ns;
  // Of noise near the frequency (noise_near_signal.hpp), against white noise.
  double noise_factor = 1.0;
  double noise_degrees_of_freedom = 0.0; // 0: those of the fit
  bool noise_unknown = false;            // slow, and the record too short to know it
  int drift_order = 0;                   // of the polynomial that was fitted beside the signal
  std::optional<ShortDisturbance> knock{};
  // Of `cleaned`, where that is the motion of a step (reference_motion.hpp).
  std::vector<std::int64_t> motion_stamps_ns{};

  [[nodiscard]] double noise_freedom() const {
    return noise_degrees_of_freedom > 0.0 ? noise_degrees_of_freedom
                                          : result.fit.degrees_of_freedom;
  }
  [[nodiscard]] std::span<const double> values() const {
    return cleaned.empty() ? samples.values : std::span<const double>(cleaned);
  }
  // Of values().
  [[nodiscard]] std::span<const std::int64_t> stamps() const {
    return motion_stamps_ns.empty() ? stamps_ns : std::span<const std::int64_t>(motion_stamps_ns);
  }
  [[nodiscard]] SineFit fit_of_values() const;
  // Of the sine before the scatter of stamps shortened it.
  [[nodiscard]] std::complex<double> phasor() const {
    return std::complex<double>(result.fit.sine, result.fit.cosine) * lengthening;
  }
  [[nodiscard]] double amplitude() const { return result.fit.amplitude() * lengthening; }
  // Of the quantity that the response is per.
  [[nodiscard]] std::complex<double> excitation() const;

  double lengthening = 1.0;
};

struct ChannelsOfOneClock {
  RecordedChannel pilot;
  std::vector<RecordedChannel> others;
};

[[nodiscard]] Expected<ChannelsOfOneClock>
fit_channels_of_one_clock(const Frequency& frequency, double frequency_search_rel,
                          std::span<const std::int64_t> stamps_ns, const ChannelSamples& pilot,
                          std::span<const ChannelSamples> others);

// One channel at a frequency that is known already. It may be too weak for a pilot, but must be 4 u
// above the noise (sine_fit.hpp).
[[nodiscard]] Expected<RecordedChannel> fit_weak_channel(const Frequency& frequency,
                                                         std::span<const std::int64_t> stamps_ns,
                                                         const ChannelSamples& channel);

// no_excitation unless the channel is 8 u above the noise.
[[nodiscard]] Expected<void> require_excitation(const RecordedChannel& channel);

enum class CountsIn { magnitude_and_phase, phase };

// Noise and quantisation of a channel that is well above the noise; `what` is the subject of
// the rows.
void add_signal_rows(Budget& budget, const std::string& what, const RecordedChannel& channel,
                     double jitter_s, CountsIn counts_in);

// Noise, quantisation and Rice's lengthening of a channel under calibration, however weak.
void add_sensor_rows(Budget& budget, const RecordedChannel& channel, double jitter_s);

// The reference's calibration: a row for every contribution, and one for what is stated beside it;
// one for the frequency, where the phasor of another quantity is made with it: by how much the
// clock and the nominal frequency differ; and those of an interferometer
// (interferometer_budget.hpp).
void add_reference_rows(Budget& budget, const RecordedChannel& reference, const Frequency& nominal,
                        const ReferenceResponse& response, double magnitude_rel, double phase_rad);

// H = P_dut * link with the budget's uncertainty. |link| is 1 / the reference's true amplitude.
[[nodiscard]] TransferPoint transfer_point(const RecordedChannel& dut, std::complex<double> link,
                                           const Budget& budget);

} // namespace dyncal::analysis
