// The covariance of a measured response and what whitens its residuals, for response_fit.
//
// Residuals are in the order ln|H| of every point, then phase of every point. Fails
// (invalid_argument) when the covariance is not positive definite in double precision. Any thread.
#pragma once

#include <span>

#include <Eigen/Core>

#include "analysis/base/error.hpp"
#include "analysis/response/response_fit.hpp"

namespace dyncal::analysis {

struct ResponseWeights {
  Eigen::VectorXd own_variance; // what each point has by itself
  Eigen::MatrixXd whitening;    // L^-1, V = L L'
};

[[nodiscard]] Expected<ResponseWeights> response_weights(std::span<const ResponsePoint> points,
                                                         const CommonResponseUncertainty& common);

} // namespace dyncal::analysis
