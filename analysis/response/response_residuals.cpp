#include "analysis/response/response_residuals.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include <ceres/jet.h>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t max_parameters = 5;

template <class T>
struct LogResponse {
  T log_magnitude;
  T phase_rad; // without polarity, not wrapped
};

// Constant beyond what a double can square twice, so that the search finds a value wherever it
// looks: a parameter that ran away is then found not to be determined.
template <class T>
T bounded_exp(const T& exponent) {
  using std::exp;
  constexpr double bound = 40.0;
  if (exponent < -bound) {
    return T(std::exp(-bound));
  }
  return exponent > bound ? T(std::exp(bound)) : exp(exponent);
}

template <class T>
LogResponse<T> log_response(const ResponseLayout& layout, const T* x, double frequency_hz) {
  using std::atan2, std::log;
  LogResponse<T> result{x[0], T(0.0)};
  if (has_delay(layout.kind)) {
    result.phase_rad = T(-2.0 * pi * frequency_hz * layout.delay_scale_s) * x[1];
  }
  if (has_first_order(layout.kind)) {
    const T ratio = bounded_exp(T(std::log(frequency_hz)) - x[layout.first()]);
    result.log_magnitude -= T(0.5) * log(T(1.0) + ratio * ratio);
    result.phase_rad -= atan2(ratio, T(1.0));
  }
  if (has_second_order(layout.kind)) {
    const T ratio = bounded_exp(T(std::log(frequency_hz)) - x[layout.second()]);
    const T real = T(1.0) - ratio * ratio;
    const T imaginary = T(2.0) * x[layout.second() + 1] * ratio;
    result.log_magnitude -= T(0.5) * log(real * real + imaginary * imaginary);
    result.phase_rad -= atan2(imaginary, real);
  }
  return result;
}

} // namespace

ResponseResiduals::ResponseResiduals(ResponseLayout layout, bool inverted,
                                     std::span<const ResponsePoint> points,
                                     Eigen::MatrixXd whitening)
    : layout_(layout), inverted_(inverted), points_(points), whitening_(std::move(whitening)) {}

bool ResponseResiduals::operator()(std::span<const double> x, std::span<double> residuals,
                                   std::span<double> jacobian) const {
  using Jet = ceres::Jet<double, static_cast<int>(max_parameters)>;
  const auto n = static_cast<Eigen::Index>(points_.size());
  const auto p = static_cast<Eigen::Index>(layout_.size());
  std::vector<Jet> jets;
  for (std::size_t k = 0; k < x.size(); ++k) {
    jets.emplace_back(x[k], static_cast<int>(k));
  }
  Eigen::VectorXd raw(2 * n);
  Eigen::MatrixXd slopes(2 * n, p);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ResponsePoint& point = points_[static_cast<std::size_t>(i)];
    const LogResponse<Jet> model = log_response(layout_, jets.data(), point.frequency_hz);
    raw(i) = model.log_magnitude.a - std::log(std::abs(point.h));
    raw(n + i) = wrap_phase(model.phase_rad.a + (inverted_ ? pi : 0.0) - std::arg(point.h));
    slopes.row(i) = model.log_magnitude.v.head(p).transpose();
    slopes.row(n + i) = model.phase_rad.v.head(p).transpose();
  }
  if (!raw.allFinite()) {
    return false;
  }
  Eigen::Map<Eigen::VectorXd>(residuals.data(), 2 * n) = whitening_ * raw;
  if (!jacobian.empty()) {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        jacobian.data(), 2 * n, p) = whitening_ * slopes;
  }
  return true;
}

std::vector<double> free_parameters(const ResponseLayout& layout, const ResponseParameters& start) {
  std::vector<double> x{std::log(std::abs(start.gain))};
  if (has_delay(layout.kind)) {
    x.push_back(start.delay_s / layout.delay_scale_s);
  }
  if (has_first_order(layout.kind)) {
    x.push_back(std::log(start.corner_hz));
  }
  if (has_second_order(layout.kind)) {
    x.push_back(std::log(start.resonance_hz));
    x.push_back(start.damping);
  }
  return x;
}

} // namespace dyncal::analysis
