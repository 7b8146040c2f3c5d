// Are the peaks of a sine bent, as by an end stop before a filter or before noise, which leaves no
// equal values? Told by the harmonics, in fixed phase to the fundamental, beside those of the
// reference.
//
// What a peak loses beyond c = cos(d) of the amplitude A, at phase pi/2 + x, is cos(x) - cos(d):
//
//   E_k = 1/pi integral (cos x - cos d) cos(kx) dx, -d..d        E_1: what the fundamental loses
//   y_k = a_+ t_k + a_- t_k*,  t_k = -i (-i)^k E_k / E_1         y_k = P_k / |P_1| e^{-ik arg P_1}
//
// so that a_+ + a_- is the relative error of the amplitude; a delay, constant over frequency, does
// not change y_k, a derivative d of time (a velocity beside a displacement: 1) makes it k^d
// i^(d (1 - k)) y_k; of several d that may be, all must show bent peaks, and the least error
// counts. Excess over the reference y_k - r_k, k = 2..10, is weighted with u^2 = noise^2 + (g
// r_k)^2 + own^2 + steps^2: g = 0.15 + (k f / (rate / 2))^2 allows for H(kf) / H(f) other than 1,
// own for a good sensor's non-linearity (0.3, 0.1, and 0.01 % from the fourth on), steps for a
// converter without noise ((q/A)^1.5 / pi^2). Of the widths 0.1, 0.2, 0.35, 0.6, 0.9 rad the one
// that fits best counts, with both ends, each alone, or each with its own size.
//
// Bent: a_+ + a_- beyond 4 u, and the shape explains 40 % of what is more than u at all, which
// chance meets in fewer than one of 1000 steps. Power, with 1500 samples: an error of 0.12 % of the
// amplitude is just found at 1 % noise, of 0.03 % at 0.1 %. Above an eighth of the sensor's rate
// harmonics fold and filters take them away: 0.8 % at a fifth. The sensor is bent where the error
// is positive, the reference where it is negative; either of the two where the other one has more
// of the harmonics: a filter may have turned them. The reference, too, where its own harmonics
// alone show it and the sensor shows less than a quarter of those up to a quarter of its rate; or
// of all, where four orders and more are those of a flat top but for a tenth. A soft knee may lose
// up to three times as much. Any thread.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/sine_residuals.hpp"

namespace dyncal::analysis {

struct ShapeHarmonic {
  int order = 2;
  std::complex<double> relative; // y_k
  double u = 0.0;                // of either part of it
};

struct SineShape {
  double order_of_half_rate = 0.0; // rate / (2 f)
  double steps_rel = 0.0;          // what steps of the converter may add to a harmonic
  double periods = 0.0;
  std::vector<ShapeHarmonic> harmonics; // in rising order
};

// Orders whose folded frequencies are apart from the signal (by 10 Hz, for the exciter may wander),
// the mean, half the rate (where only one of sine and cosine is sampled) and each other.
[[nodiscard]] std::vector<int> resolved_harmonics(double frequency_hz, double duration_s,
                                                  double rate_hz);

// `orders` of the channel. `step` of its converter, and the noise that may hide it.
[[nodiscard]] SineShape sine_shape(const Frequency& frequency, const PlainChannel& channel,
                                   std::span<const std::int64_t> stamps_ns,
                                   std::span<const int> orders, double step, double noise_sd);

struct BentPeaks {
  double amplitude_error_rel = 0.0; // > 0: the sensor is short by it; < 0: the reference
  double u = 0.0;
  double upper_rel = 0.0; // of it, at the upper peak
  double lower_rel = 0.0;
  bool found = false;
  bool of_either = false; // which of the two is bent, the orders do not tell
};

// What the sensor reads may be any of these derivatives of what the reference reads.
inline constexpr std::array same_quantity{0};
inline constexpr std::array other_quantity{0, 1, -1, 2, -2};
[[nodiscard]] BentPeaks find_bent_peaks(const SineShape& sensor, const SineShape& reference,
                                        std::span<const int> derivatives = same_quantity);

} // namespace dyncal::analysis
