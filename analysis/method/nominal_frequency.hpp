// Nominal frequency evaluation (paper section 3): the mean sample rate of a sensor from a known
// excitation alone.
//
// On the time axis of the sensor's nominal rate (sine/equidistant_axis.hpp) a four-parameter fit
// finds the apparent frequency:
//
//   lambda = f_vib / f_vib,DOS   (9)
//   f_real = f_nom lambda
//
// Eq. (10) as printed, f_nom / lambda, contradicts (6) and (9): a sensor whose clock runs fast
// senses a frequency that is too low, and its real rate is higher than nominal. (6) is the same
// relation for series time stamping. u(f_real) / f_real: apparent and applied frequency,
// independent.
//
// Fails: invalid_argument (rates or frequencies not positive). Any thread.
#pragma once

#include "analysis/base/error.hpp"

namespace dyncal::analysis {

struct NominalFrequency {
  double apparent_hz = 0.0;
  double u_apparent_hz = 0.0;
  double lambda = 1.0;
  double u_lambda = 0.0;
  double real_rate_hz = 0.0;
  double u_real_rate_hz = 0.0;
};

[[nodiscard]] Expected<NominalFrequency>
real_rate_from_apparent_frequency(double nominal_rate_hz, double applied_hz, double u_applied_hz,
                                  double apparent_hz, double u_apparent_hz);

} // namespace dyncal::analysis
