#include "analysis/response/triaxial.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace dyncal::analysis {
namespace {

constexpr double min_reciprocal_condition = 1e-6;

// Of element (i, j) of the response: row j of the inverse, with what row i leaves of each
// excitation's uncertainties.
double variance_of_element(std::span<const TriaxialExcitation> excitations,
                           const Eigen::Matrix3cd& h, const Eigen::MatrixXcd& inverse,
                           Eigen::Index i, Eigen::Index j) {
  double variance = 0.0;
  for (Eigen::Index k = 0; k < inverse.rows(); ++k) {
    const TriaxialExcitation& excitation = excitations[static_cast<std::size_t>(k)];
    double one = std::pow(excitation.u_sensor[static_cast<std::size_t>(i)], 2);
    for (Eigen::Index l = 0; l < 3; ++l) {
      one += std::norm(h(i, l)) * std::pow(excitation.u_reference[static_cast<std::size_t>(l)], 2);
    }
    variance += std::norm(inverse(k, j)) * one;
  }
  return variance;
}

} // namespace

Expected<TriaxialResponse> evaluate_triaxial(std::span<const TriaxialExcitation> excitations) {
  if (excitations.size() < 3) {
    return fail(ErrorCode::too_few_samples, "a 3x3 response needs excitations in three directions");
  }
  const auto n = static_cast<Eigen::Index>(excitations.size());
  Eigen::Matrix<std::complex<double>, 3, Eigen::Dynamic> motion(3, n), answer(3, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      motion(i, k) =
          excitations[static_cast<std::size_t>(k)].reference[static_cast<std::size_t>(i)];
      answer(i, k) = excitations[static_cast<std::size_t>(k)].sensor[static_cast<std::size_t>(i)];
    }
  }
  if (!motion.allFinite() || !answer.allFinite()) {
    return fail(ErrorCode::not_finite, "a phasor of the three axes is not a number");
  }

  const Eigen::JacobiSVD<Eigen::MatrixXcd> decomposition(motion,
                                                         Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto& singular = decomposition.singularValues();
  TriaxialResponse result;
  result.reciprocal_condition = singular(0) > 0.0 ? singular(2) / singular(0) : 0.0;
  if (!(result.reciprocal_condition > min_reciprocal_condition)) {
    return fail(ErrorCode::ill_conditioned,
                "the excitations do not move the sensor in three different directions");
  }
  const Eigen::MatrixXcd inverse = decomposition.matrixV() * singular.cwiseInverse().asDiagonal() *
                                   decomposition.matrixU().adjoint(); // n x 3
  const Eigen::Matrix3cd h = answer * inverse;

  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const double variance = variance_of_element(excitations, h, inverse, i, j);
      result.h[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = h(i, j);
      result.u[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = std::sqrt(variance);
    }
  }
  return result;
}

Expected<TransverseSensitivity>
transverse_sensitivity(const Axes& column, const std::array<double, 3>& u_column, std::size_t axis,
                       const std::array<double, 3>& own_response, double transverse_motion_rel) {
  if (axis >= 3 || !(transverse_motion_rel >= 0.0)) {
    return fail(ErrorCode::invalid_argument,
                "an axis must be 0, 1 or 2, and the bound must not be negative");
  }
  const double main = std::abs(column[axis]);
  if (!(main > 0.0)) {
    return fail(ErrorCode::no_excitation, "the excited axis did not answer");
  }
  TransverseSensitivity result;
  result.ratio[axis] = 1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i == axis) {
      continue;
    }
    const double unknown = transverse_motion_rel * own_response[i] / std::sqrt(3.0);
    result.ratio[i] = std::abs(column[i]) / main;
    result.u_ratio[i] =
        std::hypot(std::hypot(u_column[i], unknown), result.ratio[i] * u_column[axis]) / main;
    result.largest = std::max(result.largest, result.ratio[i]);
  }
  return result;
}

} // namespace dyncal::analysis
