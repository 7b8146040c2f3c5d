// A parametric model (response_model.hpp) fitted to a measured frequency response, with full
// covariance.
//
// Residuals are (ln|H_i| - ln|H|) and the phase difference modulo 2 pi, whitened with
//
//   V = diag(u_i^2) + u_gain^2 1 1'                            magnitudes
//   V = diag(u_i^2) + u_delay^2 w w' + u_phase^2 1 1'          phases
//
// so that chi_squared is a generalised least squares': what is common does not count as evidence
// against a model, and goes in full into the parameters that it moves. Nothing is enlarged by the
// scatter. u of points and covariance are of U / 2, so that the factor 2 covers; a parameter is
// known with nu = (u^2 / sum(v_i / sqrt(nu_i)))^2, v_i the share of a point in its variance, as of
// points whose u is known from the same scatter. response_start.hpp says how whole turns of the
// phase are told from a delay; other delays that fit about as well are stated.
//
// Fails as least_squares.hpp does; invalid_argument (frequencies, magnitudes or uncertainties not
// positive), too_few_samples. A robust loss refuses common parts. Any thread.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/response/least_squares.hpp"
#include "analysis/response/response_model.hpp"
#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::analysis {

struct CommonResponseUncertainty {
  double gain_rel = 0.0;
  double delay_s = 0.0;
  double phase_rad = 0.0;
};

struct ResponseResidual { // measured - model
  double magnitude_rel = 0.0;
  double phase_rad = 0.0;
  double own_magnitude_rel = 0.0; // without the estimate of what is common to all points
  double own_phase_rad = 0.0;
};

struct OtherDelay { // another minimum whose chi-squared is higher by less than 9
  double delay_s = 0.0;
  bool polarity_inverted = false;
  double chi_squared = 0.0;
};

struct FittedResponse {
  ResponseKind kind = ResponseKind::gain;
  ResponseParameters parameters;
  std::vector<std::string> names; // of the free parameters, in the order of the covariance
  std::vector<double> values;
  std::vector<CombinedUncertainty> of_values;
  std::vector<double> covariance; // of U / 2, row by row, common parts included
  double chi_squared = 0.0;
  double degrees_of_freedom = 0.0;
  std::vector<ResponseResidual> residuals; // of each point
  std::vector<std::string> undetermined;   // known no better than to half of them (zeta: 0.5)
  std::vector<OtherDelay> other_delays;    // by chi_squared
};

struct ResponseUncertainty { // U / 2 of the fitted model
  double magnitude_rel = 0.0;
  double phase_rad = 0.0;
};
[[nodiscard]] ResponseUncertainty uncertainty_at(const FittedResponse& fit, double frequency_hz);

[[nodiscard]] Expected<FittedResponse> fit_response(ResponseKind kind,
                                                    std::span<const ResponsePoint> points,
                                                    const CommonResponseUncertainty& common = {},
                                                    Loss loss = Loss::none);

} // namespace dyncal::analysis
