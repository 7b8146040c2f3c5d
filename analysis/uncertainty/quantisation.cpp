#include "analysis/uncertainty/quantisation.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t max_samples = 65536;
constexpr int tries = 16;

// The sums of a fit of sine, cosine and constant at these instants.
class Instants {
public:
  Instants(const Frequency& frequency, std::span<const std::int64_t> stamps_ns)
      : sine_(stamps_ns.size()), cosine_(stamps_ns.size()) {
    fill_sine_cosine(frequency, stamps_ns.front(), stamps_ns, sine_.data(), cosine_.data());
    for (std::size_t i = 0; i < sine_.size(); ++i) {
      s_ += sine_[i];
      c_ += cosine_[i];
      ss_ += sine_[i] * sine_[i];
      sc_ += sine_[i] * cosine_[i];
    }
    const double n = static_cast<double>(sine_.size());
    cc_ = n - ss_ - c_ * c_ / n;
    ss_ -= s_ * s_ / n;
    sc_ -= s_ * c_ / n;
  }

  // How far the phase of a sine comes out wrong when it is rounded to whole numbers.
  [[nodiscard]] double phase_error(double amplitude, double phase_rad, double offset) const {
    const double in_sine = amplitude * std::cos(phase_rad);
    const double in_cosine = amplitude * std::sin(phase_rad);
    double e = 0.0, es = 0.0, ec = 0.0;
    for (std::size_t i = 0; i < sine_.size(); ++i) {
      const double exact = in_sine * sine_[i] + in_cosine * cosine_[i] + offset;
      const double error = std::floor(exact + 0.5) - exact;
      e += error;
      es += error * sine_[i];
      ec += error * cosine_[i];
    }
    const double n = static_cast<double>(sine_.size());
    es -= e * s_ / n;
    ec -= e * c_ / n;
    const double determinant = ss_ * cc_ - sc_ * sc_;
    if (!(determinant > 0.0)) {
      return std::numbers::pi;
    }
    const std::complex<double> error((cc_ * es - sc_ * ec) / determinant,
                                     (ss_ * ec - sc_ * es) / determinant);
    return std::arg(1.0 + error / std::complex<double>(in_sine, in_cosine));
  }

private:
  std::vector<double> sine_, cosine_;
  double s_ = 0.0, c_ = 0.0, ss_ = 0.0, sc_ = 0.0, cc_ = 0.0;
};

// In steps. The tries are spread evenly over amplitude, phase and offset.
double phase_error_of_steps(double steps, const Frequency& frequency,
                            std::span<const std::int64_t> stamps_ns) {
  const Instants instants(frequency, stamps_ns.first(std::min(stamps_ns.size(), max_samples)));
  const auto spread = [](int k, double irrational) {
    return std::fmod((k + 0.5) * irrational, 1.0);
  };
  double squares = 0.0;
  for (int k = 0; k < tries; ++k) {
    const double amplitude = std::max(0.25, steps - 0.5 + spread(k, std::numbers::phi));
    const double phase_rad = 2.0 * std::numbers::pi * spread(k, std::numbers::sqrt2);
    const double error = instants.phase_error(amplitude, phase_rad, spread(k, std::numbers::sqrt3));
    squares += error * error;
  }
  return std::sqrt(squares / tries);
}

} // namespace

QuantisationUncertainty quantisation_uncertainty(double amplitude, double residual_sd,
                                                 double resolution, const Frequency& frequency,
                                                 std::span<const std::int64_t> stamps_ns) {
  if (!(resolution > 0.0)) {
    return {};
  }
  const double own_variance = resolution * resolution / 12.0;
  const double dither =
      std::sqrt(std::max(0.0, residual_sd * residual_sd - own_variance)) / resolution;
  if (dither >= 0.5) {
    return {};
  }
  const double damping = std::exp(-2.0 * std::numbers::pi * std::numbers::pi * dither * dither);
  const double steps = amplitude / resolution;
  const double bound = steps > 0.0 ? std::min(2.0 / std::numbers::pi, 0.53 / std::sqrt(steps))
                                   : 2.0 / std::numbers::pi;
  QuantisationUncertainty result;
  result.u_amplitude = resolution * bound * damping / std::sqrt(3.0);
  if (amplitude > 0.0 && !stamps_ns.empty()) {
    result.u_phase_rad = phase_error_of_steps(steps, frequency, stamps_ns) * damping;
  }
  return result;
}

} // namespace dyncal::analysis
