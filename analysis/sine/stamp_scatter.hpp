// By how much stamps that scatter shorten a fitted sine, as the residuals alone show it.
//
// A stamp that is off by d turns its sample by w d, so that a sine of amplitude a is fitted with
// A = a E[cos w d], alike in every repetition, and its residuals are larger where it is steep:
//
//   e^2 = s0^2 + V cos^2(phi) + ...      V = A^2 (1 / rho^2 - rho_2 / rho^2),  A = rho a
//   rho = sqrt(1 - V / A^2)              exact for normal scatter; ticks (uniform) and one-sided
//                                        latencies (exponential) to 5 % of 1 - rho up to w s = 0.15
//
// V is the slope of e^2 against cos(2 phi), and its uncertainty follows from the scatter of e^2
// about that line, whatever its distribution. It is known far better than the amplitude itself
// where the noise is below the signal: u(1 - rho) = 2 (s0 / A)^2 / sqrt(n) beside sqrt(2 / n) s0 /
// A. Jitter of the instants that the stamps show rightly leaves no such residuals. What is slow (an
// exciter that wanders, a filter that switches, ticks that beat with the samples) is taken away by
// a sine in each block where another correction takes care of it: blocks are as long as those in
// which the ratio is compared (phasor_blocks.hpp). A distortion, folded as it may be, is taken away
// as sines of the multiples 2 .. 10; but not where whole ticks explain what is seen.
//
// Evenly spaced blocks of at most 8192 samples in all. `peak_jumps` are residuals above the
// amplitude at the ends of the sine where there are hardly any elsewhere: samples that a converter
// wrapped. `far_off` are residuals beyond ten robust standard deviations of a sine through the
// others, at least four that are on the slopes (values of other instants) or 0.3 % anywhere (wrong
// values). `alternating`: by how much of the amplitude every second value differs from the mean
// (alternating_samples.hpp), where none are far off. `batched_part` are intervals below a
// twentieth of the mean. Fewer than 64 samples: nothing. Any thread.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/alternating_samples.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

struct StampScatter {
  double shortening_rel = 0.0; // 1 - rho, of the true amplitude; noise makes it negative, too
  double u_shortening_rel = 0.0;
  double batched_part = 0.0;
  std::uint64_t peak_jumps = 0;
  std::uint64_t far_off = 0;
  AlternatingPart alternating{};
  std::uint64_t samples = 0; // that were looked at

  // What is taken out of the amplitude: 0 where it is not certain, or as small as numbers are.
  [[nodiscard]] double correction_rel() const;
  // Of that, with what its distribution leaves open.
  [[nodiscard]] double u_correction_rel() const;
};

enum class SlowScatter { counts, corrected_in_blocks };

// `fit` about `origin_ns`, of `values`, which are without other disturbances. `step` is the
// converter's, whose errors depend on the phase: below an eighth of its square nothing is found.
[[nodiscard]] StampScatter measure_stamp_scatter(const Frequency& frequency, const SineFit& fit,
                                                 std::int64_t origin_ns,
                                                 std::span<const std::int64_t> stamps_ns,
                                                 std::span<const double> values, double step,
                                                 SlowScatter slow);

} // namespace dyncal::analysis
