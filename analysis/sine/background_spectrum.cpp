#include "analysis/sine/background_spectrum.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>

#include <unsupported/Eigen/FFT>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t min_samples = 16;
constexpr double intervals_a_period = 8.0; // of the highest line
constexpr double apart = 2.0;              // main lobe of Hann's window, in 1 / T
constexpr double apart_from_end = 1.0;     // likewise, from half the rate
constexpr int max_folded_harmonic = 10;
constexpr std::array beside{2.5, 4.0, 5.5, 7.0, 8.5, 10.0}; // in 1 / T, to either side
constexpr std::size_t min_places = 4;

struct Intervals {
  double length_s = 0.0;
  std::vector<double> weighted;
  double weights = 0.0;
};

// Means over intervals, weighted; those without samples are 0.
Intervals divide(std::span<const std::int64_t> stamps_ns, std::span<const double> residuals,
                 double length_s) {
  const double duration_s = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  const auto count = static_cast<std::size_t>(duration_s / length_s + 0.5) + 1;
  Intervals all{length_s, std::vector<double>(count), 0.0};
  std::vector<double>& sums = all.weighted;
  std::vector<std::uint32_t> samples(count);
  const double per_ns = 1e-9 / length_s;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const double place = static_cast<double>(stamps_ns[i] - stamps_ns.front()) * per_ns + 0.5;
    const auto m = std::min(static_cast<std::size_t>(std::max(place, 0.0)), count - 1);
    sums[m] += residuals[i];
    ++samples[m];
  }
  for (std::size_t m = 0; m < count; ++m) {
    if (samples[m] == 0) {
      continue;
    }
    const double angle =
        2.0 * std::numbers::pi * (static_cast<double>(m) + 0.5) / static_cast<double>(count);
    const double weight = 0.5 - 0.5 * std::cos(angle);
    sums[m] *= weight / samples[m];
    all.weights += weight;
  }
  return all;
}

std::vector<double> transform(Intervals intervals) {
  intervals.weighted.resize(std::bit_ceil(2 * intervals.weighted.size()));
  // Its tables of sines cost more than a transform: each thread keeps those of the lengths it met.
  thread_local Eigen::FFT<double> fft{Eigen::FFT<double>::impl_type(),
                                      Eigen::FFT<double>::HalfSpectrum};
  std::vector<std::complex<double>> transformed;
  fft.fwd(transformed, intervals.weighted);
  std::vector<double> squares(transformed.size());
  const double scale = 4.0 / (intervals.weights * intervals.weights);
  std::transform(transformed.begin(), transformed.end(), squares.begin(),
                 [scale](const std::complex<double>& one) { return scale * std::norm(one); });
  return squares;
}

} // namespace

std::optional<BackgroundSpectrum>
BackgroundSpectrum::of_residuals(double excitation_hz, double max_hz,
                                 std::span<const std::int64_t> stamps_ns,
                                 std::span<const double> residuals) {
  if (residuals.size() < min_samples || stamps_ns.size() != residuals.size() ||
      stamps_ns.back() <= stamps_ns.front()) {
    return std::nullopt;
  }
  BackgroundSpectrum spectrum;
  spectrum.excitation_hz_ = excitation_hz;
  spectrum.duration_s_ = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  spectrum.rate_hz_ = static_cast<double>(stamps_ns.size() - 1) / spectrum.duration_s_;
  const double samples_an_interval =
      std::max(1.0, std::floor(spectrum.rate_hz_ / (intervals_a_period * max_hz)));
  spectrum.interval_s_ = samples_an_interval / spectrum.rate_hz_;
  Intervals intervals = divide(stamps_ns, residuals, spectrum.interval_s_);
  if (!(intervals.weights > 0.0)) {
    return std::nullopt;
  }
  spectrum.squares_ = transform(std::move(intervals));
  spectrum.line_spacing_hz_ =
      0.5 / (static_cast<double>(spectrum.squares_.size() - 1) * spectrum.interval_s_);
  return spectrum;
}

bool BackgroundSpectrum::stands_apart(double seen_hz) const {
  const double margin_hz = apart / duration_s_;
  const double highest_hz = std::min(rate_hz_, 1.0 / interval_s_) / 2.0;
  if (seen_hz < margin_hz || highest_hz - seen_hz < apart_from_end / duration_s_ ||
      std::abs(std::remainder(seen_hz, excitation_hz_)) < margin_hz) {
    return false;
  }
  for (int k = 1; k <= max_folded_harmonic; ++k) {
    if (std::abs(seen_hz - folded_hz(k * excitation_hz_, rate_hz_)) < margin_hz) {
      return false;
    }
  }
  return true;
}

double BackgroundSpectrum::square_at(double seen_hz) const {
  const auto nearest = static_cast<std::size_t>(seen_hz / line_spacing_hz_ + 0.5);
  const double angle = std::numbers::pi * seen_hz * interval_s_;
  const double shortened = angle > 0.0 ? std::sin(angle) / angle : 1.0;
  return squares_[std::min(nearest, squares_.size() - 1)] / (shortened * shortened);
}

// Standard uncertainty of either component.
std::optional<double> BackgroundSpectrum::noise_beside(double seen_hz) const {
  std::vector<double> squares;
  for (const double distance : beside) {
    for (const double place_hz :
         {seen_hz - distance / duration_s_, seen_hz + distance / duration_s_}) {
      if (stands_apart(place_hz)) {
        squares.push_back(square_at(place_hz));
      }
    }
  }
  if (squares.size() < min_places) {
    return std::nullopt;
  }
  // The squares have an exponential distribution of the mean 2 u^2, with its median at ln 2.
  return std::sqrt(median(squares) / (2.0 * std::numbers::ln2));
}

std::optional<LineAmplitude> BackgroundSpectrum::line(double seen_hz) const {
  if (!stands_apart(seen_hz)) {
    return std::nullopt;
  }
  const auto u_component = noise_beside(seen_hz);
  return u_component ? std::optional(LineAmplitude{std::sqrt(square_at(seen_hz)), *u_component})
                     : std::nullopt;
}

} // namespace dyncal::analysis
