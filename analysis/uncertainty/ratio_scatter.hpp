// How the ratio of two sines recorded together scatters along their record: a test of the
// assumption that the residuals of a sine approximation are white.
//
// The record is divided into m = 4..16 blocks of the same whole number of periods; r_k = P_num,k /
// P_den,k is the ratio of the phasors of block k. The scatter of |P_num,k| and of arg r_k about
// their means gives standard uncertainties of the record's mean, s / sqrt(m) (more when
// neighbouring blocks are correlated), that contain what the residuals of the whole record hide or
// take for white: settling remnants, hum and neighbouring lines that beat with the signal, slow
// noise. Drift of the clock cancels in the ratio.
//
// Empty when the record holds fewer than four periods, or a block is too thin or too weak (|P| < 3
// u) to be evaluated. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct RatioScatter {
  double u_magnitude_rel = 0.0; // of the numerator alone
  double u_phase_rad = 0.0;     // of the ratio
  double degrees_of_freedom = 0.0;
};

[[nodiscard]] std::optional<RatioScatter> ratio_scatter(const Frequency& frequency,
                                                        std::span<const std::int64_t> stamps_ns,
                                                        std::span<const double> numerator,
                                                        std::span<const double> denominator);

// What `observed` shows beyond `expected`, both standard uncertainties: sqrt(observed^2 -
// expected^2) where the ratio of the variances is larger than white noise gives once in a thousand
// (chi-squared, `degrees_of_freedom`), 0 otherwise. So white records keep the uncertainty, and with
// it the coverage, that theory gives them.
[[nodiscard]] double significant_excess(double observed, double expected,
                                        double degrees_of_freedom);

} // namespace dyncal::analysis
