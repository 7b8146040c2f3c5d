#include "analysis/response/response_weights.hpp"

#include <numbers>

#include <Eigen/Cholesky>

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

Eigen::MatrixXd covariance_of(std::span<const ResponsePoint> points,
                              const CommonResponseUncertainty& common) {
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const ResponsePoint& a = points[static_cast<std::size_t>(i)];
      const ResponsePoint& b = points[static_cast<std::size_t>(j)];
      const double w2 = 4.0 * pi * pi * a.frequency_hz * b.frequency_hz;
      covariance(i, j) = common.gain_rel * common.gain_rel +
                         (i == j ? a.u_magnitude_rel * a.u_magnitude_rel : 0.0);
      covariance(n + i, n + j) = common.phase_rad * common.phase_rad +
                                 w2 * common.delay_s * common.delay_s +
                                 (i == j ? a.u_phase_rad * a.u_phase_rad : 0.0);
    }
  }
  return covariance;
}

} // namespace

Expected<ResponseWeights> response_weights(std::span<const ResponsePoint> points,
                                           const CommonResponseUncertainty& common) {
  const auto n = static_cast<Eigen::Index>(points.size());
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance_of(points, common));
  if (factor.info() != Eigen::Success) {
    return fail(ErrorCode::invalid_argument,
                "the uncertainties that the points have in common are too large against their own");
  }
  return ResponseWeights{covariance_of(points, {}).diagonal(),
                         factor.matrixL().solve(Eigen::MatrixXd::Identity(2 * n, 2 * n))};
}

} // namespace dyncal::analysis
