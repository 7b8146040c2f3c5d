#include "analysis/response/response_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Core>

#include "analysis/response/response_residuals.hpp"
#include "analysis/response/response_start.hpp"
#include "analysis/response/response_weights.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double max_log_u = 0.5; // of a frequency that counts as determined; of zeta if below 1
constexpr double other_delay_chi_squared = 9.0; // above the lowest
constexpr double alike_chi_squared = 1.0;       // the smaller delay is taken

// One end of the search.
struct Minimum {
  bool inverted = false;
  LeastSquaresSolution solution;
  double delay_s = 0.0;
  double u_delay_s = 0.0;
};

class ResponseSearch {
public:
  ResponseSearch(ResponseLayout layout, std::span<const ResponsePoint> points,
                 const ResponseWeights& weights, Loss loss)
      : layout_(layout), points_(points), weights_(weights), loss_(loss) {}

  // From every start, lowest chi-squared first; or why there is none.
  [[nodiscard]] Expected<std::vector<Minimum>> minima() const {
    std::vector<Minimum> found;
    Error last{ErrorCode::not_converged, "the model was not fitted from any start"};
    for (const ResponseParameters& start : response_starts(layout_.kind, points_)) {
      auto minimum = from(free_parameters(layout_, start), start.gain < 0.0, Search::quick);
      if (minimum) {
        found.push_back(std::move(*minimum));
      } else {
        last = minimum.error();
      }
    }
    if (found.empty()) {
      return fail(last);
    }
    sort(found);
    erase_alike(found);
    for (Minimum& minimum : found) {
      auto better = from(minimum.solution.parameters, minimum.inverted, Search::thorough);
      if (better && better->solution.rss < minimum.solution.rss) {
        minimum = std::move(*better);
      }
    }
    sort(found);
    return found;
  }

private:
  static void sort(std::vector<Minimum>& minima) {
    std::stable_sort(minima.begin(), minima.end(), [](const Minimum& a, const Minimum& b) {
      return a.solution.rss < b.solution.rss;
    });
  }

  // Keeps the lowest of those with the same delay and polarity, and of them those near the lowest
  // of all.
  void erase_alike(std::vector<Minimum>& minima) const {
    std::vector<Minimum> kept;
    const double alike_s = 0.25 / points_.back().frequency_hz;
    for (Minimum& minimum : minima) {
      const bool known = std::any_of(kept.begin(), kept.end(), [&](const Minimum& other) {
        return other.inverted == minimum.inverted &&
               std::abs(other.delay_s - minimum.delay_s) < alike_s;
      });
      const double above = kept.empty() ? 0.0 : minimum.solution.rss - kept.front().solution.rss;
      if (!known && above < 2.0 * other_delay_chi_squared) {
        kept.push_back(std::move(minimum));
      }
    }
    minima = std::move(kept);
  }

  [[nodiscard]] Expected<Minimum> from(std::vector<double> start, bool inverted,
                                       Search search) const {
    LeastSquaresProblem problem;
    problem.residuals = 2 * points_.size();
    problem.start = std::move(start);
    problem.evaluate = ResponseResiduals(layout_, inverted, points_, weights_.whitening);
    problem.loss = loss_;
    problem.search = search;
    return solve_least_squares(problem).map([&](LeastSquaresSolution solution) {
      Minimum minimum{inverted, std::move(solution)};
      if (has_delay(layout_.kind)) {
        minimum.delay_s = layout_.delay_scale_s * minimum.solution.parameters[1];
        minimum.u_delay_s = layout_.delay_scale_s * minimum.solution.u(1);
      }
      return minimum;
    });
  }

  ResponseLayout layout_;
  std::span<const ResponsePoint> points_;
  const ResponseWeights& weights_;
  Loss loss_;
};

// Of minima that fit equally well the smallest delay that is not clearly below 0.
std::size_t preferred(const std::vector<Minimum>& minima) {
  const auto rank = [](const Minimum& minimum) {
    return std::pair(minimum.delay_s < -3.0 * minimum.u_delay_s, std::abs(minimum.delay_s));
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < minima.size(); ++i) {
    if (minima[i].solution.rss < minima.front().solution.rss + alike_chi_squared &&
        rank(minima[i]) < rank(minima[best])) {
      best = i;
    }
  }
  return best;
}

// Measured - model, and what remains of it without the most probable errors that all points have in
// common: D V^-1 r, D = diag(u_i^2).
std::vector<ResponseResidual> residuals_of(const ResponseParameters& parameters,
                                           std::span<const ResponsePoint> points,
                                           const ResponseWeights& weights) {
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::VectorXd raw(2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ResponsePoint& point = points[static_cast<std::size_t>(i)];
    const std::complex<double> ratio = point.h / response_at(parameters, point.frequency_hz);
    raw(i) = std::log(std::abs(ratio));
    raw(n + i) = std::arg(ratio);
  }
  const Eigen::VectorXd own =
      weights.own_variance.cwiseProduct(weights.whitening.transpose() * (weights.whitening * raw));
  std::vector<ResponseResidual> residuals;
  for (Eigen::Index i = 0; i < n; ++i) {
    residuals.push_back({raw(i), raw(n + i), own(i), own(n + i)});
  }
  return residuals;
}

// The point that a row of residuals is of states how well its u is known.
double degrees_of_freedom(std::span<const ResponsePoint> points, Eigen::Index row) {
  const auto i = static_cast<std::size_t>(row);
  return i < points.size() ? points[i].magnitude_degrees_of_freedom
                           : points[i - points.size()].phase_degrees_of_freedom;
}

// From the share of each point's own variance in that of each parameter.
std::vector<CombinedUncertainty> uncertainties_of(const FittedResponse& fit,
                                                  std::span<const ResponsePoint> points,
                                                  const ResponseWeights& weights) {
  const auto n = static_cast<Eigen::Index>(points.size());
  const auto p = static_cast<Eigen::Index>(fit.values.size());
  Eigen::MatrixXd slopes(2 * n, p);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto of_point =
        log_slopes(fit.kind, fit.parameters, points[static_cast<std::size_t>(i)].frequency_hz);
    for (Eigen::Index k = 0; k < p; ++k) {
      slopes(i, k) = of_point[static_cast<std::size_t>(k)].real();
      slopes(n + i, k) = of_point[static_cast<std::size_t>(k)].imag();
    }
  }
  const Eigen::Map<const Eigen::MatrixXd> covariance(fit.covariance.data(), p, p);
  const Eigen::MatrixXd moves =
      covariance * (weights.whitening * slopes).transpose() * weights.whitening;
  std::vector<CombinedUncertainty> all;
  for (Eigen::Index k = 0; k < p; ++k) {
    double over_roots = 0.0;
    for (Eigen::Index row = 0; row < 2 * n; ++row) {
      over_roots += moves(k, row) * moves(k, row) * weights.own_variance(row) /
                    std::sqrt(degrees_of_freedom(points, row));
    }
    CombinedUncertainty of_value;
    if (over_roots > 0.0) {
      of_value.degrees_of_freedom = std::pow(covariance(k, k) / over_roots, 2);
      of_value.k = coverage_factor(of_value.degrees_of_freedom);
    }
    of_value.u = 2.0 * std::sqrt(covariance(k, k)) / of_value.k;
    all.push_back(of_value);
  }
  return all;
}

void find_undetermined(const ResponseLayout& layout, const LeastSquaresSolution& solution,
                       FittedResponse& result) {
  for (std::size_t k = layout.first(); k < layout.size(); ++k) {
    const bool is_damping = has_second_order(layout.kind) && k + 1 == layout.size();
    const double unit = is_damping ? std::max(1.0, std::abs(solution.parameters[k])) : 1.0;
    if (!(solution.u(k) <= max_log_u * unit)) {
      result.undetermined.push_back(result.names[k]);
    }
  }
}

FittedResponse describe(const ResponseLayout& layout, bool inverted,
                        const LeastSquaresSolution& solution) {
  FittedResponse result;
  result.kind = layout.kind;
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
  if (has_delay(layout.kind)) {
    result.parameters.delay_s = take("delay_s", layout.delay_scale_s * x[1], layout.delay_scale_s);
  }
  if (has_first_order(layout.kind)) {
    const double corner_hz = std::exp(x[layout.first()]);
    result.parameters.corner_hz = take("corner_hz", corner_hz, corner_hz);
  }
  if (has_second_order(layout.kind)) {
    const std::size_t k = layout.second();
    result.parameters.resonance_hz = take("resonance_hz", std::exp(x[k]), std::exp(x[k]));
    result.parameters.damping = take("damping", x[k + 1], 1.0);
  }
  for (std::size_t a = 0; a < x.size(); ++a) {
    for (std::size_t b = 0; b < x.size(); ++b) {
      result.covariance.push_back(slopes[a] * slopes[b] * solution.covariance_of(a, b));
    }
  }
  result.chi_squared = solution.rss;
  result.degrees_of_freedom = solution.degrees_of_freedom;
  return result;
}

Expected<void> check(ResponseKind kind, std::span<const ResponsePoint> points,
                     const CommonResponseUncertainty& common, Loss loss) {
  for (const ResponsePoint& point : points) {
    if (!(point.frequency_hz > 0.0) || !(std::abs(point.h) > 0.0) ||
        !std::isfinite(std::abs(point.h)) || !(point.u_magnitude_rel > 0.0) ||
        !(point.u_phase_rad > 0.0)) {
      return fail(ErrorCode::invalid_argument, "every point of a response needs a frequency, a "
                                               "magnitude and uncertainties above 0");
    }
  }
  if (loss != Loss::none &&
      (common.gain_rel > 0.0 || common.delay_s > 0.0 || common.phase_rad > 0.0)) {
    return fail(ErrorCode::invalid_argument,
                "a robust fit takes points that are independent, without common uncertainties");
  }
  if (2 * points.size() <= parameter_count(kind)) {
    return fail(ErrorCode::too_few_samples, "a model of " + std::to_string(parameter_count(kind)) +
                                                " parameters needs more frequencies than " +
                                                std::to_string(points.size()));
  }
  return {};
}

} // namespace

ResponseUncertainty uncertainty_at(const FittedResponse& fit, double frequency_hz) {
  const std::vector<std::complex<double>> slopes =
      log_slopes(fit.kind, fit.parameters, frequency_hz);
  double magnitude = 0.0, phase = 0.0;
  for (std::size_t a = 0; a < slopes.size(); ++a) {
    for (std::size_t b = 0; b < slopes.size(); ++b) {
      const double covariance = fit.covariance[a * slopes.size() + b];
      magnitude += slopes[a].real() * slopes[b].real() * covariance;
      phase += slopes[a].imag() * slopes[b].imag() * covariance;
    }
  }
  return {std::sqrt(std::max(0.0, magnitude)), std::sqrt(std::max(0.0, phase))};
}

Expected<FittedResponse> fit_response(ResponseKind kind, std::span<const ResponsePoint> points,
                                      const CommonResponseUncertainty& common, Loss loss) {
  DYNCAL_TRY(check(kind, points, common, loss));
  std::vector<ResponsePoint> rising(points.begin(), points.end());
  std::stable_sort(rising.begin(), rising.end(),
                   [](const auto& a, const auto& b) { return a.frequency_hz < b.frequency_hz; });
  DYNCAL_TRY(const auto weights, response_weights(rising, common));
  const ResponseLayout layout{kind, 1.0 / (2.0 * pi * rising.back().frequency_hz)};
  DYNCAL_TRY(const auto minima, ResponseSearch(layout, rising, weights, loss).minima());
  const std::size_t chosen = preferred(minima);
  const Minimum& best = minima[chosen];
  FittedResponse result = describe(layout, best.inverted, best.solution);
  result.of_values = uncertainties_of(result, rising, weights);
  find_undetermined(layout, best.solution, result);
  for (std::size_t i = 0; i < minima.size(); ++i) {
    const Minimum& other = minima[i];
    if (i != chosen && other.solution.rss < best.solution.rss + other_delay_chi_squared) {
      result.other_delays.push_back({other.delay_s, other.inverted, other.solution.rss});
    }
  }
  // In the order of the points as they were given.
  const auto own_weights = response_weights(points, common);
  result.residuals = residuals_of(result.parameters, points, *own_weights);
  return result;
}

} // namespace dyncal::analysis
