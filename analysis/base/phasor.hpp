// Phasors and their phase.
//
//   P = A + iB   of y = A sin(w (t - t_0)) + B cos(w (t - t_0)),   theta = atan2(B, A)
//
// theta is lead, in radians (ISO 2041). Only atan2 is used; a phase difference is the argument of P
// conj(Q), never the difference of two phases. Any thread.
#pragma once

#include <complex>

namespace dyncal::analysis {

// z / |z|; 1 for z = 0.
[[nodiscard]] std::complex<double> unit_phasor(std::complex<double> z);

// The angle reduced to (-pi, pi].
[[nodiscard]] double wrap_phase(double angle_rad);

// Standard uncertainty of the phase of a phasor whose magnitude is `snr` times the standard
// uncertainty of each of its components. Above 10 this is 1 / snr. Below it is the standard
// deviation of the phase of a bivariate normal distribution at the distance sqrt(snr^2 - 2) (the
// squared magnitude of noise alone is 2 on average, Rice), which tends to pi / sqrt(3), that of an
// angle of which nothing is known.
[[nodiscard]] double phase_standard_uncertainty(double snr);

} // namespace dyncal::analysis
