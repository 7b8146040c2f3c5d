// Weights of M-estimation: how much a residual r counts, given the scale of the good ones.
//
//   x = r / scale
//   Huber              w = 1 for |x| <= 1.345, else 1.345 / |x|
//   Tukey's biweight   w = (1 - (x / 4.685)^2)^2 for |x| <= 4.685, else 0
//
// Both constants give 95 % efficiency on normal noise. psi = w r; psi' its derivative by r. After
// P. J. Huber and E. M. Ronchetti, Robust Statistics, 2nd ed., sections 4 and 7. Any thread.
#pragma once

#include <span>

namespace dyncal::analysis {

enum class Weighting { none, huber, tukey };

[[nodiscard]] double robust_weight(Weighting weighting, double residual, double scale);
[[nodiscard]] double robust_slope(Weighting weighting, double residual, double scale); // psi'

// 1.4826 times the median of |r|: the standard deviation of normal residuals. Reorders what it is
// given.
[[nodiscard]] double robust_scale(std::span<double> absolute_residuals);

} // namespace dyncal::analysis
