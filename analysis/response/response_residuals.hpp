// What a model of a response leaves of the points that were measured, for response_fit: residuals
// ln|H| and phase of every point, whitened (response_weights.hpp), with their derivatives by the
// parameters, which Ceres' jets carry along.
//
// Free parameters: ln|g|, then tau / scale, ln fc, ln f0, zeta as far as the kind has them.
// Logarithms keep frequencies positive; zeta may come out below 0, as chance has it, when it is
// nearly 0. Thread-compatible.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "analysis/response/response_fit.hpp"

namespace dyncal::analysis {

// Where each parameter stands.
struct ResponseLayout {
  ResponseKind kind;
  double delay_scale_s;

  [[nodiscard]] std::size_t size() const { return parameter_count(kind); }
  [[nodiscard]] std::size_t first() const { return has_delay(kind) ? 2 : 1; }
  [[nodiscard]] std::size_t second() const { return first() + (has_first_order(kind) ? 1 : 0); }
};

[[nodiscard]] std::vector<double> free_parameters(const ResponseLayout& layout,
                                                  const ResponseParameters& start);

// `points` outlive it. `inverted`: the sensor's polarity is.
class ResponseResiduals {
public:
  ResponseResiduals(ResponseLayout layout, bool inverted, std::span<const ResponsePoint> points,
                    Eigen::MatrixXd whitening);

  // As LeastSquaresProblem::evaluate.
  bool operator()(std::span<const double> x, std::span<double> residuals,
                  std::span<double> jacobian) const;

private:
  ResponseLayout layout_;
  bool inverted_;
  std::span<const ResponsePoint> points_;
  Eigen::MatrixXd whitening_;
};

} // namespace dyncal::analysis
