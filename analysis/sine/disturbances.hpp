// Sine approximation that looks for disturbances first: harmonics of the exciter, mains hum and
// drift, which are not white, leak into the phasor (a line h by up to h / (pi |f - f_h| T), a
// linear drift D over half the record of m periods by 0.64 D / m), and are not in the covariance of
// the residuals.
//
// Each channel is fitted with three parameters (paper eq. (1)). Its residuals are searched for
// drift (drift_order.hpp), then for harmonics 2..10 and for the mains with their first two
// multiples, below 0.45 of the mean sample rate and at least 1.5 / T away from the harmonics. What
// exceeds 4.5 standard uncertainties (by chance: 4 in 100 000) is fitted beside the signal
// (extended_sine_fit.hpp). A clean channel therefore keeps the plain three-parameter result, bit
// for bit; so does one whose disturbance cannot be separated from the signal. Drift that is neither
// clear nor excluded widens the covariance.
//
// The frequency is estimated in the same way: again on the samples without what was found beside
// it.
//
// Fails as sine_fit.hpp does. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/sine/mains.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "analysis/sine/sine_residuals.hpp"

namespace dyncal::analysis {

struct CleanedFit {
  SineFit fit;
  std::vector<double> removed_hz; // what was fitted beside it
  int drift_order = 0;            // of the polynomial fitted beside it
  std::vector<double> values;     // the samples without it; empty when nothing was removed
  PlainChannel plain;             // as the samples came
};

[[nodiscard]] Expected<std::vector<CleanedFit>>
fit_sine_beside_disturbances(const Frequency& frequency, std::int64_t phase_origin_ns,
                             std::span<const std::int64_t> stamps_ns,
                             std::span<const std::span<const double>> channels,
                             std::span<const double> mains_hz = usual_mains_hz);

// fit_sine_and_frequency() beside disturbances.
[[nodiscard]] Expected<FrequencyFit> fit_frequency_beside_disturbances(
    const Frequency& start, double search_rel, std::int64_t phase_origin_ns,
    std::span<const std::int64_t> stamps_ns, std::span<const std::span<const double>> channels,
    std::span<const double> mains_hz = usual_mains_hz);

// The frequency of the first channel, beside its disturbances, and all channels at this frequency;
// these are empty where they remain to be fitted, for the disturbances moved the frequency or
// another channel cannot be fitted.
struct PilotFit {
  Frequency frequency;
  double u_frequency_hz = 0.0;
  std::vector<CleanedFit> channels;
};
[[nodiscard]] Expected<PilotFit>
fit_pilot_beside_disturbances(const Frequency& start, double search_rel,
                              std::int64_t phase_origin_ns, std::span<const std::int64_t> stamps_ns,
                              std::span<const std::span<const double>> channels,
                              std::span<const double> mains_hz = usual_mains_hz);

} // namespace dyncal::analysis
