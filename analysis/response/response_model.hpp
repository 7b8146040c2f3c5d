// Parametric models of a frequency response.
//
//   H(f) = +-g [e^{-i 2 pi f tau}] [1 / (1 + i f / fc)] [1 / (1 - (f / f0)^2 + 2 i zeta f / f0)]
//
// Brackets are chosen by the kind: a delay; a first-order low pass (the front end of an ADC); a
// second-order system (seismic transducer, the low-pass filter of a MEMS sensor). psi = arg H is
// lead, tau > 0 a delay, the sign of g the polarity.
//
// response_fit.hpp finds the parameters. Plain functions, any thread.
#pragma once

#include <array>
#include <complex>
#include <string_view>
#include <vector>

#include "analysis/uncertainty/contribution.hpp"

namespace dyncal::analysis {

enum class ResponseKind { // in the order of their number of parameters
  gain,
  delay, // every kind has a gain
  first_order,
  first_order_with_delay,
  second_order,
  second_order_with_delay,
  second_and_first_order_with_delay
};

inline constexpr std::array all_response_kinds{ResponseKind::gain,
                                               ResponseKind::delay,
                                               ResponseKind::first_order,
                                               ResponseKind::first_order_with_delay,
                                               ResponseKind::second_order,
                                               ResponseKind::second_order_with_delay,
                                               ResponseKind::second_and_first_order_with_delay};

[[nodiscard]] std::string_view to_string(ResponseKind kind); // for people
[[nodiscard]] std::string_view name_of(ResponseKind kind);   // for programs: "second_order"
[[nodiscard]] std::size_t parameter_count(ResponseKind kind);
[[nodiscard]] bool has_delay(ResponseKind kind);
[[nodiscard]] bool has_first_order(ResponseKind kind);
[[nodiscard]] bool has_second_order(ResponseKind kind);

struct ResponsePoint {
  double frequency_hz = 0.0;
  std::complex<double> h;
  double u_magnitude_rel = 0.0; // U / 2, independent from point to point
  double u_phase_rad = 0.0;
  double magnitude_degrees_of_freedom = infinite_degrees_of_freedom;
  double phase_degrees_of_freedom = infinite_degrees_of_freedom;
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

// d ln H / d parameter, in the order gain, delay_s, corner_hz, resonance_hz, damping as far as the
// kind has them: of ln|H| the real, of the phase the imaginary part.
[[nodiscard]] std::vector<std::complex<double>>
log_slopes(ResponseKind kind, const ResponseParameters& parameters, double frequency_hz);

} // namespace dyncal::analysis
