// Parametric models of a measured frequency response, fitted with full covariance. No program uses
// them yet.
//
//   H(f) = +-g e^{-i 2 pi f tau} [1 / (1 + i f / fc)] [1 / (1 - (f / f0)^2 + 2 i zeta f / f0)]
//
// Brackets are chosen by the kind: a pure delay; a first-order low pass (the front end of an ADC);
// a second-order system (seismic transducer, the digital low-pass filter of a MEMS sensor); both.
// psi = arg H is lead, tau > 0 a delay, the sign of g the polarity.
//
// Residuals are (ln|H_i| - ln|H|) / u_rel and the phase difference modulo 2 pi / u_phase, whitened
// with diag(u_i^2) and what is common: u_gain to all magnitudes, u_delay w and u_phase to all
// phases. The search starts from the group delay and a few corner frequencies; the best end is
// taken. A robust loss (Huber, Tukey) acts on the residuals without the common parts, which it
// therefore refuses. chi_squared / degrees_of_freedom far above 1: the model is not the sensor's.
//
// Fails as least_squares.hpp and group_delay.hpp do; invalid_argument (uncertainties not positive).
// Any thread.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/response/least_squares.hpp"

namespace dyncal::analysis {

enum class ResponseKind { delay, first_order, second_order, second_and_first_order };

struct ResponsePoint {
  double frequency_hz = 0.0;
  std::complex<double> h;
  double u_magnitude_rel = 0.0; // independent from point to point
  double u_phase_rad = 0.0;
};

struct CommonResponseUncertainty {
  double gain_rel = 0.0;
  double delay_s = 0.0;
  double phase_rad = 0.0;
};

struct ResponseParameters {
  double gain = 1.0; // negative: inverted polarity
  double delay_s = 0.0;
  double corner_hz = 0.0;    // first order; 0: none
  double resonance_hz = 0.0; // second order; 0: none
  double damping = 0.0;
};

[[nodiscard]] std::complex<double> response_at(const ResponseParameters& parameters,
                                               double frequency_hz);

struct FittedResponse {
  ResponseParameters parameters;
  std::vector<std::string> names; // of the free parameters, in the order of the covariance
  std::vector<double> values;
  std::vector<double> u;
  std::vector<double> covariance; // row by row, common parts included
  double chi_squared = 0.0;
  double degrees_of_freedom = 0.0;
};

[[nodiscard]] Expected<FittedResponse> fit_response(ResponseKind kind,
                                                    std::span<const ResponsePoint> points,
                                                    const CommonResponseUncertainty& common = {},
                                                    Loss loss = Loss::none);

} // namespace dyncal::analysis
