// A digital filter that undoes a fitted response in samples of the sensor: the deconvolution filter
// with low pass, by weighted least squares in the frequency domain (the design idea of Elster and
// Link 2008).
//
//   C(f) = B(e^{iw}) / A(e^{iw}),  w = 2 pi f / rate       C(f) H(f) = e^{-i w D}   for f <= cutoff
//
// A is 1 (FIR) or the poles of a digital Butterworth low pass (IIR), chosen beforehand and so
// without uncertainty: the filter is stable whatever the response. B minimises
//
//   sum |H (C - e^{-iwD} / H)|^2 (pass band)  +  0.1^2 sum |C g|^2 (stop band)
//
// between which the target falls off as a raised cosine with little weight. The covariance of B
// follows from that of the parameters, U_b = J U J' with J = d b / d(parameters) of target and
// weights, and has their number as its rank.
//
// D is the whole number of samples by which the output is late; unless it is given, the one with
// the smallest error is taken. `ripple` is what the design leaves, max |C H e^{iwD} - 1|.
//
// Fails: invalid_argument (the sentence names the setting). Any thread.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/response/response_fit.hpp"

namespace dyncal::analysis {

struct CompensationSettings {
  double rate_hz = 0.0;
  double cutoff_hz = 0.0; // end of the pass band
  int poles = 0;          // 0: FIR
  int taps = 0;           // of B; 0: by the width between pass and stop band
  std::optional<int> delay_samples{};
};

struct CompensationFilter {
  std::vector<double> b;
  std::vector<double> a;            // a[0] = 1
  std::vector<double> covariance_b; // row by row
  double rate_hz = 0.0;
  double cutoff_hz = 0.0;
  double stop_hz = 0.0; // begin of the stop band; rate / 2: there is none
  int delay_samples = 0;
  double ripple = 0.0;     // in the pass band
  double stop_gain = 0.0;  // largest |C g| in the stop band; 0 without one
  double noise_gain = 0.0; // of white noise: rms of C g over all frequencies
};

[[nodiscard]] Expected<CompensationFilter>
design_compensation(const FittedResponse& response, const CompensationSettings& settings);

[[nodiscard]] std::complex<double> response_at(const CompensationFilter& filter,
                                               double frequency_hz);

struct CompensatedPoint { // C H e^{iwD} against 1
  double frequency_hz = 0.0;
  double magnitude_error = 0.0; // with the fitted model: what the design leaves
  double phase_error_rad = 0.0;
  double u_magnitude = 0.0; // of the parameters (k = 1)
  double u_phase_rad = 0.0;
  double measured_magnitude_error = 0.0; // with the measured value
  double measured_phase_error_rad = 0.0;
};

[[nodiscard]] std::vector<CompensatedPoint> compensate(const CompensationFilter& filter,
                                                       const FittedResponse& response,
                                                       std::span<const ResponsePoint> points);

} // namespace dyncal::analysis
