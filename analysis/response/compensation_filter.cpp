#include "analysis/response/compensation_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/QR>

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double transition_weight = 0.01;
constexpr double stop_weight = 0.1;
constexpr int min_taps = 33, max_taps = 257; // of those chosen here
constexpr int max_wanted_taps = 513;
constexpr int max_poles = 8;
constexpr double taps_per_width = 4.0; // times rate / (stop - cutoff)

using Complex = std::complex<double>;

Complex polynomial_at(const std::vector<double>& coefficients, double w) {
  const Complex step = std::polar(1.0, -w);
  Complex sum;
  for (auto coefficient = coefficients.rbegin(); coefficient != coefficients.rend();
       ++coefficient) {
    sum = sum * step + *coefficient;
  }
  return sum;
}

// 1, a1, ... of the digital Butterworth low pass (bilinear, -3 dB at the frequency).
std::vector<double> butterworth_poles(int order, double frequency_hz, double rate_hz) {
  const double analogue = 2.0 * rate_hz * std::tan(pi * frequency_hz / rate_hz);
  std::vector<Complex> polynomial{1.0};
  for (int k = 0; k < order; ++k) {
    const Complex s = std::polar(analogue, pi * (2.0 * k + order + 1.0) / (2.0 * order));
    const Complex pole = (2.0 * rate_hz + s) / (2.0 * rate_hz - s);
    polynomial.emplace_back(0.0);
    for (std::size_t i = polynomial.size() - 1; i > 0; --i) {
      polynomial[i] -= pole * polynomial[i - 1];
    }
  }
  std::vector<double> a;
  std::transform(polynomial.begin(), polynomial.end(), std::back_inserter(a),
                 [](const Complex& coefficient) { return coefficient.real(); });
  return a;
}

struct GridPoint {
  double frequency_hz = 0.0;
  double weight = 0.0;
  double wanted = 0.0; // of C H without delay: 1 in the pass band, 0 in the stop band
};

class Design {
public:
  Design(const FittedResponse& response, CompensationFilter filter, int taps)
      : response_(response), filter_(std::move(filter)), taps_(taps) {
    add_grid();
    matrix_.resize(2 * rows(), taps_);
    for (Eigen::Index i = 0; i < rows(); ++i) {
      const GridPoint& point = grid_[static_cast<std::size_t>(i)];
      const double w = angle(point.frequency_hz);
      const Complex weight = point.weight / polynomial_at(filter_.a, w);
      for (int k = 0; k < taps_; ++k) {
        const Complex value = weight * std::polar(1.0, -w * k);
        matrix_(i, k) = value.real();
        matrix_(rows() + i, k) = value.imag();
      }
    }
    factor_.compute(matrix_);
  }

  // The delay with the smallest sum of squares; all candidates at once.
  [[nodiscard]] int best_delay() const {
    const double lag = response_.parameters.delay_s * filter_.rate_hz;
    const bool fir = filter_.a.size() == 1;
    const int first = static_cast<int>(std::ceil(lag + (fir ? 0.35 * taps_ : 0.0)));
    const int count = fir ? std::max(8, taps_ / 3) : 2 * taps_;
    int best = first;
    double lowest = std::numeric_limits<double>::infinity();
    for (int delay = std::max(0, first); delay < std::max(0, first) + count; ++delay) {
      const Eigen::VectorXd projected = factor_.householderQ().adjoint() * target(delay);
      const double left = projected.tail(projected.size() - taps_).squaredNorm();
      if (left < lowest * (1.0 - 1e-9)) {
        lowest = left;
        best = delay;
      }
    }
    return best;
  }

  [[nodiscard]] CompensationFilter finish(int delay) {
    filter_.delay_samples = delay;
    const Eigen::VectorXd b = factor_.solve(target(delay));
    filter_.b.assign(b.begin(), b.end());
    add_covariance(delay);
    add_errors();
    return filter_;
  }

private:
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(grid_.size()); }
  [[nodiscard]] double angle(double frequency_hz) const {
    return 2.0 * pi * frequency_hz / filter_.rate_hz;
  }
  [[nodiscard]] Complex model(double frequency_hz) const {
    return analysis::response_at(response_.parameters, frequency_hz);
  }

  void add_grid() {
    const int intervals = std::max(200, 4 * taps_);
    const double nyquist = 0.5 * filter_.rate_hz;
    const double gain = std::abs(response_.parameters.gain);
    for (int i = 0; i <= intervals; ++i) {
      GridPoint point{.frequency_hz = nyquist * i / intervals};
      if (point.frequency_hz <= filter_.cutoff_hz) {
        point.weight = std::abs(model(point.frequency_hz));
        point.wanted = 1.0;
      } else if (point.frequency_hz < filter_.stop_hz) {
        const double place =
            (point.frequency_hz - filter_.cutoff_hz) / (filter_.stop_hz - filter_.cutoff_hz);
        point.weight = transition_weight * std::abs(model(point.frequency_hz));
        point.wanted = 0.5 + 0.5 * std::cos(pi * place);
      } else {
        point.weight = stop_weight * gain;
      }
      grid_.push_back(point);
    }
  }

  // Weighted, with the factor that each frequency's value is multiplied by.
  template <class FactorAt>
  [[nodiscard]] Eigen::VectorXd target(int delay, FactorAt factor_at) const {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(2 * rows());
    for (Eigen::Index i = 0; i < rows(); ++i) {
      const GridPoint& point = grid_[static_cast<std::size_t>(i)];
      if (point.wanted > 0.0) {
        const Complex value = point.weight * point.wanted *
                              std::polar(1.0, -angle(point.frequency_hz) * delay) /
                              model(point.frequency_hz) * factor_at(point.frequency_hz);
        values(i) = value.real();
        values(rows() + i) = value.imag();
      }
    }
    return values;
  }
  [[nodiscard]] Eigen::VectorXd target(int delay) const {
    return target(delay, [](double) { return Complex(1.0); });
  }

  // d b / d parameter: target and weights move with the parameters, w = w(x), t = w T, A b ~ t:
  //   A'A db = A' (w dT + 2 d(ln w) (t - A b))
  void add_covariance(int delay) {
    const auto p = static_cast<Eigen::Index>(response_.values.size());
    const Eigen::Map<const Eigen::VectorXd> b(filter_.b.data(), taps_);
    const Eigen::VectorXd residuals = target(delay) - matrix_ * b;
    Eigen::MatrixXd jacobian(taps_, p);
    for (Eigen::Index k = 0; k < p; ++k) {
      const auto slope_at = [&](double frequency_hz) {
        return log_slopes(response_.kind, response_.parameters,
                          frequency_hz)[static_cast<std::size_t>(k)];
      };
      Eigen::VectorXd change = target(delay, [&](double f) { return -slope_at(f); });
      for (Eigen::Index i = 0; i < rows(); ++i) {
        const GridPoint& point = grid_[static_cast<std::size_t>(i)];
        const double frequency_hz = point.frequency_hz < filter_.stop_hz ? point.frequency_hz : 0.0;
        const double weight_slope = 2.0 * slope_at(frequency_hz).real();
        change(i) += weight_slope * residuals(i);
        change(rows() + i) += weight_slope * residuals(rows() + i);
      }
      jacobian.col(k) = factor_.solve(change);
    }
    const Eigen::Map<const Eigen::MatrixXd> covariance(response_.covariance.data(), p, p);
    const Eigen::MatrixXd half = 0.5 * jacobian * covariance * jacobian.transpose();
    const Eigen::MatrixXd result = half + half.transpose(); // symmetric to the last digit
    filter_.covariance_b.assign(result.data(), result.data() + result.size());
  }

  void add_errors() {
    constexpr int intervals = 4000;
    const double gain = std::abs(response_.parameters.gain);
    const double nyquist = 0.5 * filter_.rate_hz;
    double squares = 0.0;
    for (int i = 0; i <= intervals; ++i) {
      const double passed_hz = filter_.cutoff_hz * i / intervals;
      const Complex whole =
          analysis::response_at(filter_, passed_hz) * model(passed_hz) *
          std::polar(1.0, angle(passed_hz) * static_cast<double>(filter_.delay_samples));
      filter_.ripple = std::max(filter_.ripple, std::abs(whole - 1.0));
      const double anywhere_hz = nyquist * i / intervals;
      squares += std::norm(analysis::response_at(filter_, anywhere_hz) * gain) / (intervals + 1.0);
      const double stopped_hz = filter_.stop_hz + (nyquist - filter_.stop_hz) * i / intervals;
      if (filter_.stop_hz < nyquist) {
        filter_.stop_gain = std::max(filter_.stop_gain,
                                     std::abs(analysis::response_at(filter_, stopped_hz)) * gain);
      }
    }
    filter_.noise_gain = std::sqrt(squares);
  }

  const FittedResponse& response_;
  CompensationFilter filter_;
  int taps_;
  std::vector<GridPoint> grid_;
  Eigen::MatrixXd matrix_;
  Eigen::HouseholderQR<Eigen::MatrixXd> factor_;
};

Expected<void> check(const CompensationSettings& settings) {
  const auto invalid = [](const std::string& sentence) {
    return fail(ErrorCode::invalid_argument, sentence);
  };
  if (!(settings.rate_hz > 0.0) || !std::isfinite(settings.rate_hz)) {
    return invalid("the sample rate of a filter must be above 0 Hz");
  }
  if (!(settings.cutoff_hz > 0.0) || !(settings.cutoff_hz < 0.5 * settings.rate_hz)) {
    return invalid("the cutoff of a filter must be above 0 Hz and below half the sample rate");
  }
  if (settings.taps < 0 || settings.taps == 1 || settings.taps > max_wanted_taps) {
    return invalid("a filter needs from 2 to " + std::to_string(max_wanted_taps) + " taps");
  }
  if (settings.poles < 0 || settings.poles > max_poles) {
    return invalid("a filter needs from 0 to " + std::to_string(max_poles) + " poles");
  }
  if (settings.delay_samples && *settings.delay_samples < 0) {
    return invalid("the delay of a filter must not be below 0 samples");
  }
  return {};
}

int taps_for(const CompensationSettings& settings, double stop_hz) {
  if (settings.taps > 0) {
    return settings.taps;
  }
  const double width = taps_per_width * settings.rate_hz / (stop_hz - settings.cutoff_hz);
  return std::clamp(2 * static_cast<int>(0.5 * width) + 1, min_taps, max_taps);
}

} // namespace

Expected<CompensationFilter> design_compensation(const FittedResponse& response,
                                                 const CompensationSettings& settings) {
  DYNCAL_TRY(check(settings));
  CompensationFilter filter;
  filter.rate_hz = settings.rate_hz;
  filter.cutoff_hz = settings.cutoff_hz;
  filter.stop_hz = std::min(2.0 * settings.cutoff_hz, 0.5 * settings.rate_hz);
  filter.a = butterworth_poles(settings.poles, 0.5 * (filter.cutoff_hz + filter.stop_hz),
                               settings.rate_hz);
  Design design(response, filter, taps_for(settings, filter.stop_hz));
  return design.finish(settings.delay_samples ? *settings.delay_samples : design.best_delay());
}

std::complex<double> response_at(const CompensationFilter& filter, double frequency_hz) {
  const double w = 2.0 * pi * frequency_hz / filter.rate_hz;
  return polynomial_at(filter.b, w) / polynomial_at(filter.a, w);
}

std::vector<CompensatedPoint> compensate(const CompensationFilter& filter,
                                         const FittedResponse& response,
                                         std::span<const ResponsePoint> points) {
  std::vector<CompensatedPoint> result;
  for (const ResponsePoint& point : points) {
    const double f = point.frequency_hz;
    const Complex undo = response_at(filter, f) *
                         std::polar(1.0, 2.0 * pi * f / filter.rate_hz * filter.delay_samples);
    const Complex modelled = undo * response_at(response.parameters, f);
    const Complex measured = undo * point.h;
    const ResponseUncertainty u = uncertainty_at(response, f);
    result.push_back({f, std::abs(modelled) - 1.0, std::arg(modelled),
                      std::abs(modelled) * u.magnitude_rel, u.phase_rad, std::abs(measured) - 1.0,
                      std::arg(measured)});
  }
  return result;
}

} // namespace dyncal::analysis
