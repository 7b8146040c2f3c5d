// What an ellipse is fitted from: the sums of u1^i u2^j up to the fourth order, in one pass and
// without keeping a sample.
//
// The sums are of (u - centre) / scale, so that no digit is lost; moments of other blocks, records
// or steps add up, whatever their centre and scale. Beside them are kept the extremes, and the sum
// of the squares of fourth differences, which is 70 times the variance of white noise where the
// signals are slow from sample to sample. The same samples in the same blocks give the same bits.
//
// What is not finite shows as sums that are not; the fit then refuses. No synchronisation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "analysis/interferometer/kernel/quadrature_kernel.hpp"

namespace dyncal::analysis {

struct SignalRange {
  double low = 0.0;
  double high = 0.0;

  [[nodiscard]] double middle() const { return low + (high - low) / 2.0; }
  [[nodiscard]] double half() const { return (high - low) / 2.0; }
};

struct SignalScale {
  double centre = 0.0;
  double scale = 1.0;
};

// Means of x^i y^j, i + j <= 4; the others are zero.
using QuadratureMeans = std::array<std::array<double, 5>, 5>;

class EllipseMoments {
public:
  // REQUIRES: as many samples of u1 as of u2.
  void add(std::span<const std::int16_t> u1, std::span<const std::int16_t> u2);
  void add(std::span<const float> u1, std::span<const float> u2);
  void add(std::span<const double> u1, std::span<const double> u2);
  void add(const EllipseMoments& other);

  [[nodiscard]] std::uint64_t samples() const { return samples_; }
  [[nodiscard]] const SignalRange& range_1() const { return range_1_; }
  [[nodiscard]] const SignalRange& range_2() const { return range_2_; }
  // Variance of white noise by the fourth differences, in the unit of the signal; zero without any.
  [[nodiscard]] double difference_variance_1() const;
  [[nodiscard]] double difference_variance_2() const;
  // About another centre and in another scale. REQUIRES: samples.
  [[nodiscard]] QuadratureMeans means(const SignalScale& scale_1, const SignalScale& scale_2) const;
  // About the means, in units of the half ranges. REQUIRES: samples, signals that change.
  [[nodiscard]] SignalScale own_scale_1() const;
  [[nodiscard]] SignalScale own_scale_2() const;

private:
  template <class Number>
  void add_samples(std::span<const Number> u1, std::span<const Number> u2);

  SignalScale scale_1_;
  SignalScale scale_2_;
  SignalRange range_1_;
  SignalRange range_2_;
  std::uint64_t samples_ = 0;
  std::uint64_t differences_ = 0;
  double difference_squares_1_ = 0.0; // in the unit of the signal
  double difference_squares_2_ = 0.0;
  std::array<double, kernel::quadrature_moments> sums_{};
};

} // namespace dyncal::analysis
