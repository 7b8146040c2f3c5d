#include "analysis/interferometer/ellipse_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "analysis/interferometer/rounded_text.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::uint64_t fewest_ellipse_samples = 16;
constexpr double largest_radius_scatter = 0.05;
constexpr double largest_noise_share = 0.05;

using Conic = Eigen::Matrix<double, 5, 1>; // A, B, C, D, E
using ConicMatrix = Eigen::Matrix<double, 5, 5>;

constexpr std::size_t conic_exponents[5][2] = {{2, 0}, {1, 1}, {0, 2}, {1, 0}, {0, 1}};

// The parameters of the ellipse in scaled coordinates, or nothing if the conic is none.
std::optional<Ellipse> ellipse_of(Conic conic) {
  double constant = 1.0; // A x^2 + ... = constant
  if (conic[0] < 0.0) {
    conic = -conic;
    constant = -constant;
  }
  const auto [a, b, c, d, e] = std::array{conic[0], conic[1], conic[2], conic[3], conic[4]};
  const double discriminant = b * b - 4.0 * a * c;
  if (!(discriminant < 0.0)) {
    return std::nullopt;
  }
  Ellipse result;
  result.p = (2.0 * c * d - b * e) / discriminant;
  result.q = (2.0 * a * e - b * d) / discriminant;
  result.r = std::sqrt(c / a);
  result.alpha_rad = std::asin(b / (2.0 * std::sqrt(a * c)));
  const double size =
      a * result.p * result.p + b * result.p * result.q + c * result.q * result.q + constant;
  if (!(size > 0.0)) {
    return std::nullopt;
  }
  result.radius = std::sqrt(size / a) / std::cos(result.alpha_rad);
  return result;
}

Eigen::Matrix<double, 5, 1> vector_of(const Ellipse& ellipse) {
  return {ellipse.p, ellipse.q, ellipse.r, ellipse.alpha_rad, ellipse.radius};
}

// Means of the noise-free points: each power is replaced by the polynomial whose expectation it is.
QuadratureMeans adjusted_means(const QuadratureMeans& means, double variance_x, double variance_y) {
  const auto polynomials = [](double v) {
    return std::array<std::array<double, 5>, 5>{{{1.0, 0.0, 0.0, 0.0, 0.0},
                                                 {0.0, 1.0, 0.0, 0.0, 0.0},
                                                 {-v, 0.0, 1.0, 0.0, 0.0},
                                                 {0.0, -3.0 * v, 0.0, 1.0, 0.0},
                                                 {3.0 * v * v, 0.0, -6.0 * v, 0.0, 1.0}}};
  };
  const auto of_x = polynomials(variance_x);
  const auto of_y = polynomials(variance_y);
  QuadratureMeans result{};
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = 0; i + j < 5; ++j) {
      for (std::size_t a = 0; a <= i; ++a) {
        for (std::size_t b = 0; b <= j; ++b) {
          result[i][j] += of_x[i][a] * of_y[j][b] * means[a][b];
        }
      }
    }
  }
  return result;
}

struct ConicFit {
  Conic conic;
  ConicMatrix inverse;      // of the normal equations of means
  double mean_square = 0.0; // of the algebraic distances
};

std::optional<ConicFit> fit_conic(const QuadratureMeans& means) {
  ConicMatrix normal;
  Conic right;
  for (int row = 0; row < 5; ++row) {
    const auto& [i, j] = conic_exponents[row];
    right[row] = means[i][j];
    for (int column = 0; column < 5; ++column) {
      const auto& [k, l] = conic_exponents[column];
      normal(row, column) = means[i + k][j + l];
    }
  }
  const Eigen::FullPivLU<ConicMatrix> solver(normal);
  if (!solver.isInvertible()) {
    return std::nullopt;
  }
  ConicFit fit;
  fit.conic = solver.solve(right);
  fit.inverse = solver.inverse();
  fit.mean_square =
      std::max(0.0, fit.conic.dot(normal * fit.conic) - 2.0 * fit.conic.dot(right) + means[0][0]);
  return fit;
}

// By differences; every derivative is of the order of one in scaled coordinates.
std::optional<ConicMatrix> parameters_by_conic(const Conic& conic) {
  ConicMatrix derivatives;
  const double step = 1e-6 * conic.cwiseAbs().maxCoeff();
  for (int column = 0; column < 5; ++column) {
    Conic above = conic;
    Conic below = conic;
    above[column] += step;
    below[column] -= step;
    const auto high = ellipse_of(above);
    const auto low = ellipse_of(below);
    if (!high || !low) {
      return std::nullopt;
    }
    derivatives.col(column) = (vector_of(*high) - vector_of(*low)) / (2.0 * step);
  }
  return derivatives;
}

// What one ellipse in scaled coordinates is fitted from, and what turns it into the signals' unit.
struct ScaledRecord {
  QuadratureMeans means;
  SignalScale scale_1;
  SignalScale scale_2;
  double samples;

  [[nodiscard]] Ellipse in_unit(const Ellipse& scaled) const {
    return {scale_1.centre + scaled.p * scale_1.scale, scale_2.centre + scaled.q * scale_2.scale,
            scaled.r * scale_1.scale / scale_2.scale, scaled.alpha_rad,
            scaled.radius * scale_1.scale};
  }
};

struct ScaledEllipse {
  Ellipse ellipse;
  ConicFit fit;

  // Of the radius. The algebraic distance is A cos(alpha)^2 (rho^2 - R^2).
  [[nodiscard]] double radius_variance() const {
    const double cosine = std::cos(ellipse.alpha_rad);
    const double by_radius = 2.0 * fit.conic[0] * cosine * cosine * ellipse.radius;
    return fit.mean_square / (by_radius * by_radius);
  }
};

std::optional<ScaledEllipse> fit_scaled(const QuadratureMeans& means) {
  const auto fit = fit_conic(means);
  const auto ellipse = fit ? ellipse_of(fit->conic) : std::nullopt;
  if (!ellipse) {
    return std::nullopt;
  }
  return ScaledEllipse{*ellipse, *fit};
}

constexpr const char* other_ellipse_advice =
    "Use the ellipse of another step (the one with the longest arc) or of a file, or let the "
    "reference mirror move by half a wavelength during the step.";

tl::unexpected<Error> no_ellipse() {
  return fail(ErrorCode::ill_conditioned,
              std::string("the two signals of the interferometer do not lie on an ellipse. Look at "
                          "u2 over u1: they must be of one quadrature pair, not clipped, and move "
                          "along an arc. ") +
                  other_ellipse_advice);
}

Expected<void> check_record(const EllipseMoments& moments) {
  if (moments.samples() < fewest_ellipse_samples) {
    return fail(ErrorCode::too_few_samples,
                std::to_string(moments.samples()) +
                    " samples of the interferometer are too few for an ellipse; it needs " +
                    std::to_string(fewest_ellipse_samples) + " at least");
  }
  if (moments.range_1().half() == 0.0 || moments.range_2().half() == 0.0) {
    return fail(ErrorCode::ill_conditioned,
                std::string("signal ") + (moments.range_1().half() == 0.0 ? "u1" : "u2") +
                    " of the interferometer never changes; look at its cable and its photodiode");
  }
  const double scale = moments.own_scale_1().centre + moments.own_scale_2().centre;
  if (!std::isfinite(scale) || !std::isfinite(moments.range_1().half()) ||
      !std::isfinite(moments.range_2().half())) {
    return fail(ErrorCode::not_finite,
                "the signals of the interferometer hold values that are not finite");
  }
  return {};
}

Expected<void> check_plausible(const EllipseFit& fit, double half_range) {
  const Ellipse& ellipse = fit.ellipse;
  std::string finding;
  if (!(ellipse.radius > 0.2 * half_range && ellipse.radius < 5.0 * half_range)) {
    finding = "its radius " + rounded_text(ellipse.radius, 4) + " does not suit signals of +-" +
              rounded_text(half_range, 4);
  } else if (!(ellipse.r > 0.4 && ellipse.r < 2.5)) {
    finding = "the amplitudes of its signals have the ratio " + rounded_text(ellipse.r, 3);
  } else if (!(std::abs(ellipse.alpha_rad) < std::numbers::pi / 6.0)) {
    finding = "its signals are " + rounded_text(ellipse.alpha_rad * 180.0 / std::numbers::pi, 3) +
              " degrees from quadrature";
  } else if (!(fit.radius_residual_sd < largest_radius_scatter * ellipse.radius)) {
    finding = "the radius scatters by " +
              rounded_text(100.0 * fit.radius_residual_sd / ellipse.radius, 2) + " % around it";
  } else {
    return {};
  }
  return fail(ErrorCode::ill_conditioned,
              "the ellipse of the interferometer is not to be trusted: " + finding + ". " +
                  other_ellipse_advice);
}

struct BothEllipses {
  std::optional<ScaledEllipse> linear;
  std::optional<ScaledEllipse> adjusted;
  double variance_1 = 0.0; // of the noise, in the unit of the signal
  double variance_2 = 0.0;
};

BothEllipses fit_both(const EllipseMoments& moments, const ScaledRecord& record) {
  BothEllipses both;
  both.linear = fit_scaled(record.means);
  both.variance_1 = moments.difference_variance_1();
  both.variance_2 = moments.difference_variance_2();
  if (both.linear) {
    const double of_radius =
        both.linear->radius_variance() * record.scale_1.scale * record.scale_1.scale;
    const double r = record.in_unit(both.linear->ellipse).r;
    both.variance_1 = std::min(both.variance_1, of_radius);
    both.variance_2 = std::min(both.variance_2, of_radius / (r * r));
  }
  both.adjusted = fit_scaled(
      adjusted_means(record.means, both.variance_1 / (record.scale_1.scale * record.scale_1.scale),
                     both.variance_2 / (record.scale_2.scale * record.scale_2.scale)));
  return both;
}

// Covariance of the conic by its algebraic distances, then of the parameters.
Expected<void> put_covariance(const ScaledRecord& record, const ScaledEllipse& scaled,
                              double mean_square, EllipseFit& fit) {
  const auto derivatives = parameters_by_conic(scaled.fit.conic);
  if (!derivatives) {
    return no_ellipse();
  }
  const double s1 = record.scale_1.scale;
  const double s2 = record.scale_2.scale;
  const Conic units{s1, s2, s1 / s2, 1.0, s1};
  const ConicMatrix in_unit = units.asDiagonal() * *derivatives;
  const ConicMatrix covariance =
      in_unit * scaled.fit.inverse * in_unit.transpose() * (mean_square / fit.degrees_of_freedom);
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 5; ++column) {
      fit.covariance[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] =
          covariance(row, column);
    }
  }
  return {};
}

// Mean square of the algebraic distances of the points, noise and all, from an ellipse.
double mean_square_distance(const QuadratureMeans& means, const Conic& conic) {
  double sum = means[0][0];
  for (int row = 0; row < 5; ++row) {
    const auto& [i, j] = conic_exponents[row];
    sum -= 2.0 * conic[row] * means[i][j];
    for (int column = 0; column < 5; ++column) {
      const auto& [k, l] = conic_exponents[column];
      sum += conic[row] * conic[column] * means[i + k][j + l];
    }
  }
  return std::max(0.0, sum);
}

} // namespace

std::string_view to_string(EllipseMethod method) {
  return method == EllipseMethod::linear ? "linear least squares" : "adjusted least squares";
}

Expected<EllipseFit> fit_ellipse_by(EllipseMethod method, const EllipseMoments& moments) {
  DYNCAL_TRY(check_record(moments));
  const SignalScale scale_1 = moments.own_scale_1();
  const SignalScale scale_2 = moments.own_scale_2();
  const ScaledRecord record{moments.means(scale_1, scale_2), scale_1, scale_2,
                            static_cast<double>(moments.samples())};
  const BothEllipses both = fit_both(moments, record);
  const auto& chosen = method == EllipseMethod::linear ? both.linear : both.adjusted;
  if (!chosen) {
    return no_ellipse();
  }
  EllipseFit fit;
  fit.ellipse = record.in_unit(chosen->ellipse);
  fit.method = method;
  fit.noise_sd_1 = std::sqrt(both.variance_1);
  fit.noise_sd_2 = std::sqrt(both.variance_2);
  fit.degrees_of_freedom = record.samples - static_cast<double>(ellipse_parameters);
  ScaledEllipse of_points = *chosen;
  of_points.fit.mean_square = mean_square_distance(record.means, chosen->fit.conic);
  fit.radius_residual_sd = std::sqrt(of_points.radius_variance()) * scale_1.scale;
  DYNCAL_TRY(check_plausible(fit, moments.range_1().half()));
  if (!both.linear || !both.adjusted ||
      std::abs(both.adjusted->ellipse.radius / both.linear->ellipse.radius - 1.0) >
          largest_noise_share) {
    return fail(ErrorCode::ill_conditioned,
                std::string("the arc of the interferometer is so short that noise decides its "
                            "ellipse. ") +
                    other_ellipse_advice);
  }
  DYNCAL_TRY(put_covariance(record, *chosen, of_points.fit.mean_square, fit));
  return fit;
}

Expected<EllipseFit> fit_ellipse(const EllipseMoments& moments, double turns_covered) {
  if (!(turns_covered >= shortest_ellipse_turns)) {
    return fail(ErrorCode::ill_conditioned,
                "the phase of the interferometer covers " + rounded_text(turns_covered, 2) +
                    " turns, and an ellipse needs " + rounded_text(shortest_ellipse_turns, 2) +
                    " at least. " + other_ellipse_advice);
  }
  const EllipseMethod method =
      turns_covered >= linear_ellipse_turns ? EllipseMethod::linear : EllipseMethod::adjusted;
  DYNCAL_TRY(EllipseFit fit, fit_ellipse_by(method, moments));
  fit.turns_covered = turns_covered;
  return fit;
}

} // namespace dyncal::analysis
