// The order of the polynomial drift beside a sine, 0 to 3, chosen by the data.
//
//   y = A sin + B cos + C + d_1 u + ... + d_k u^k       u = -1 .. 1 over the record
//   gain(k) = (rss(0) - rss(k)) / s^2(k)                chi-squared with k degrees without drift
//
// k is that of the largest gain(k) - 10 k: white noise alone chooses an order above 0 once in 300
// records. First the residuals of the plain fit are projected on polynomials; only where these say
// something, or in records of less than 12 periods, where sine and drift resemble each other, the
// orders are fitted in full.
//
// A drift just below that limit is not taken out and shifts the phasor. The next order has the
// probability w = 1 / (1 + e^{(10 - gain) / 2}) (Bayes, equal chances); where that is more than 5
// %, w (1 - w) times the square of what it would change is added to the covariance.
//
// Fails never: an order that cannot be fitted is not chosen. Any thread.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/extended_sine_fit.hpp"
#include "analysis/sine/sine_residuals.hpp"

namespace dyncal::analysis {

inline constexpr int max_drift_order = 3;

// What the residuals of a plain fit show.
struct DriftEvidence {
  int order = 0;                                    // that seems needed
  bool decided = true;                              // false: the orders have to be fitted in full
  std::array<double, max_drift_order + 1> powers{}; // coefficients of u^0 .. u^3 up to that order

  [[nodiscard]] std::span<const double> polynomial() const; // u^1 .. u^order
};
[[nodiscard]] DriftEvidence find_drift(double periods, const TimeSums& residuals);

// Takes powers[0] u + powers[1] u^2 + ... away.
void remove_drift(std::span<const double> powers, std::span<const std::int64_t> stamps_ns,
                  std::span<double> values);

struct DriftChoice {
  std::optional<ExtendedFit> model; // of the chosen order and the basis; none: the plain fit holds
  double probability = 0.0;         // w of the next order, 0 where it is not worth stating
  std::complex<double> change{};    // of the phasor if the next order were taken
};

// `beside` holds what else is fitted; its own order is not looked at.
[[nodiscard]] DriftChoice choose_drift_order(const Frequency& frequency,
                                             const ExtendedBasis& beside,
                                             const DriftEvidence& evidence, const SineFit& plain,
                                             std::int64_t phase_origin_ns,
                                             std::span<const std::int64_t> stamps_ns,
                                             std::span<const double> values);

void add_undetected_drift(const DriftChoice& choice, SineFit& fit);

} // namespace dyncal::analysis
