#include "analysis/response/response_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Cholesky>
#include <ceres/jet.h>

#include "analysis/base/phasor.hpp"
#include "analysis/response/group_delay.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t max_parameters = 5;

bool has_first_order(ResponseKind kind) {
  return kind == ResponseKind::first_order || kind == ResponseKind::second_and_first_order;
}
bool has_second_order(ResponseKind kind) {
  return kind == ResponseKind::second_order || kind == ResponseKind::second_and_first_order;
}

// Free parameters: ln|g|, tau / scale, then ln fc, then ln f0, ln zeta. Logarithms keep them
// positive.
struct Layout {
  ResponseKind kind;
  double delay_scale_s;

  [[nodiscard]] std::size_t size() const {
    return 2 + (has_first_order(kind) ? 1 : 0) + (has_second_order(kind) ? 2 : 0);
  }
  [[nodiscard]] std::size_t second() const { return has_first_order(kind) ? 3 : 2; }
};

template <class T>
struct LogResponse {
  T log_magnitude;
  T phase_rad; // without polarity, not wrapped
};

template <class T>
LogResponse<T> log_response(const Layout& layout, const T* x, double frequency_hz) {
  using std::atan2, std::exp, std::log;
  LogResponse<T> result{x[0], T(-2.0 * pi * frequency_hz * layout.delay_scale_s) * x[1]};
  if (has_first_order(layout.kind)) {
    const T ratio = T(frequency_hz) * exp(-x[2]);
    result.log_magnitude -= T(0.5) * log(T(1.0) + ratio * ratio);
    result.phase_rad -= atan2(ratio, T(1.0));
  }
  if (has_second_order(layout.kind)) {
    const T ratio = T(frequency_hz) * exp(-x[layout.second()]);
    const T real = T(1.0) - ratio * ratio;
    const T imaginary = T(2.0) * exp(x[layout.second() + 1]) * ratio;
    result.log_magnitude -= T(0.5) * log(real * real + imaginary * imaginary);
    result.phase_rad -= atan2(imaginary, real);
  }
  return result;
}

// What multiplies the residuals so that they become independent with unit variance: L^-1, V = L L'.
// Magnitudes first, then phases.
Expected<Eigen::MatrixXd> whitening(std::span<const ResponsePoint> points,
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
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  if (factor.info() != Eigen::Success) {
    return fail(ErrorCode::invalid_argument, "the uncertainties of a response must be positive");
  }
  return Eigen::MatrixXd(factor.matrixL().solve(Eigen::MatrixXd::Identity(2 * n, 2 * n)));
}

class ResponseResiduals {
public:
  ResponseResiduals(Layout layout, bool inverted, std::span<const ResponsePoint> points,
                    Eigen::MatrixXd whitening)
      : layout_(layout), inverted_(inverted), points_(points), whitening_(std::move(whitening)) {}

  bool operator()(std::span<const double> x, std::span<double> residuals,
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

private:
  Layout layout_;
  bool inverted_;
  std::span<const ResponsePoint> points_;
  Eigen::MatrixXd whitening_;
};

struct Start {
  double delay_s = 0.0;
  bool inverted = false;
};

Expected<Start> start_of(std::span<const ResponsePoint> points) {
  std::vector<PhasePoint> phases;
  for (const ResponsePoint& point : points) {
    phases.push_back({point.frequency_hz, std::arg(point.h), point.u_phase_rad});
  }
  const auto delay = evaluate_group_delay(phases);
  if (!delay) {
    return fail(delay.error());
  }
  return Start{delay->delay_s, delay->polarity_inverted};
}

// Corner frequencies from below to far above what was measured; the part of the delay that the
// corner explains is taken off it.
std::vector<std::vector<double>> starting_points(const Layout& layout, const Start& start,
                                                 std::span<const ResponsePoint> points) {
  std::vector<std::vector<double>> result;
  const double log_gain = std::log(std::abs(points.front().h));
  const double highest = points.back().frequency_hz;
  if (layout.kind == ResponseKind::delay) {
    return {{log_gain, start.delay_s / layout.delay_scale_s}};
  }
  for (const double corner : {0.5 * highest, highest, 2.0 * highest, 6.0 * highest}) {
    const double explained =
        has_second_order(layout.kind) ? 1.4 / (2.0 * pi * corner) : 1.0 / (2.0 * pi * corner);
    std::vector<double> x{log_gain, (start.delay_s - explained) / layout.delay_scale_s};
    if (has_first_order(layout.kind)) {
      x.push_back(std::log(has_second_order(layout.kind) ? 4.0 * corner : corner));
    }
    if (has_second_order(layout.kind)) {
      x.push_back(std::log(corner));
      x.push_back(std::log(0.7));
    }
    result.push_back(std::move(x));
  }
  return result;
}

FittedResponse describe(const Layout& layout, bool inverted, const LeastSquaresSolution& solution) {
  FittedResponse result;
  const std::vector<double>& x = solution.parameters;
  std::vector<double> slopes; // d parameter / d x
  const auto take = [&](const char* name, double value, double slope) {
    result.names.emplace_back(name);
    result.values.push_back(value);
    slopes.push_back(slope);
    return value;
  };
  const double gain = (inverted ? -1.0 : 1.0) * std::exp(x[0]);
  result.parameters.gain = take("gain", gain, gain);
  result.parameters.delay_s = take("delay_s", layout.delay_scale_s * x[1], layout.delay_scale_s);
  if (has_first_order(layout.kind)) {
    result.parameters.corner_hz = take("corner_hz", std::exp(x[2]), std::exp(x[2]));
  }
  if (has_second_order(layout.kind)) {
    const std::size_t k = layout.second();
    result.parameters.resonance_hz = take("resonance_hz", std::exp(x[k]), std::exp(x[k]));
    result.parameters.damping = take("damping", std::exp(x[k + 1]), std::exp(x[k + 1]));
  }
  for (std::size_t a = 0; a < x.size(); ++a) {
    for (std::size_t b = 0; b < x.size(); ++b) {
      result.covariance.push_back(slopes[a] * slopes[b] * solution.covariance_of(a, b));
    }
    result.u.push_back(std::abs(slopes[a]) * solution.u(a));
  }
  result.chi_squared = solution.rss;
  result.degrees_of_freedom = solution.degrees_of_freedom;
  return result;
}

} // namespace

std::complex<double> response_at(const ResponseParameters& parameters, double frequency_hz) {
  std::complex<double> h =
      parameters.gain * std::polar(1.0, -2.0 * pi * frequency_hz * parameters.delay_s);
  if (parameters.corner_hz > 0.0) {
    h /= std::complex<double>(1.0, frequency_hz / parameters.corner_hz);
  }
  if (parameters.resonance_hz > 0.0) {
    const double ratio = frequency_hz / parameters.resonance_hz;
    h /= std::complex<double>(1.0 - ratio * ratio, 2.0 * parameters.damping * ratio);
  }
  return h;
}

Expected<FittedResponse> fit_response(ResponseKind kind, std::span<const ResponsePoint> points,
                                      const CommonResponseUncertainty& common, Loss loss) {
  for (const ResponsePoint& point : points) {
    if (!(std::abs(point.h) > 0.0) || !(point.u_magnitude_rel > 0.0) ||
        !(point.u_phase_rad > 0.0)) {
      return fail(ErrorCode::invalid_argument,
                  "every point of a response needs a magnitude and positive uncertainties");
    }
  }
  if (loss != Loss::none &&
      (common.gain_rel > 0.0 || common.delay_s > 0.0 || common.phase_rad > 0.0)) {
    return fail(ErrorCode::invalid_argument,
                "a robust fit takes points that are independent, without common uncertainties");
  }
  const auto start = start_of(points);
  if (!start) {
    return fail(start.error());
  }
  const auto white = whitening(points, common);
  if (!white) {
    return fail(white.error());
  }
  const Layout layout{kind, 1.0 / (2.0 * pi * points.back().frequency_hz)};

  LeastSquaresProblem problem;
  problem.residuals = 2 * points.size();
  problem.evaluate = ResponseResiduals(layout, start->inverted, points, *white);
  problem.loss = loss;
  Expected<LeastSquaresSolution> best =
      fail(ErrorCode::not_converged, "the model was not fitted from any start");
  for (std::vector<double>& x : starting_points(layout, *start, points)) {
    problem.start = std::move(x);
    auto solution = solve_least_squares(problem);
    if (!best || (solution && solution->rss < best->rss)) {
      best = std::move(solution);
    }
  }
  if (!best) {
    return fail(best.error());
  }
  return describe(layout, start->inverted, *best);
}

} // namespace dyncal::analysis
