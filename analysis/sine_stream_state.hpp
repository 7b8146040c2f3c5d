// The inside of SineStream: what is kept of a stream. Used by sine_stream.cpp (samples in, three parameters out) and
// sine_stream_frequency.cpp (the frequency out of the kept series); see sine_stream.hpp for model, units and failures.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/sine_kernel.hpp"
#include "analysis/sine_series.hpp"
#include "analysis/sine_solve.hpp"
#include "analysis/sine_stream.hpp"

namespace dyncal::analysis {
namespace kernel {

using Complex = std::complex<double>;

inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected(Error{code, std::move(message)});
}

// A plain product: std::complex's own would look for infinities.
inline Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// Sums over any number of blocks, phases about the first stamp: enough for three parameters.
struct Totals {
  double n = 0.0;
  Complex x, xx;
  struct Channel {
    double e = 0.0, ee = 0.0;
    Complex ex;
  };
  std::vector<Channel> channels;

  void add(const DesignSeries& design, const std::vector<ResidualSeries>& residuals) {
    n += design.u[0];
    x += design.x[0];
    xx += design.xx[0];
    for (std::size_t j = 0; j < residuals.size(); ++j) {
      channels[j].e += residuals[j].e;
      channels[j].ee += residuals[j].ee;
      channels[j].ex += residuals[j].ex[0];
    }
  }
  [[nodiscard]] DesignSums design() const { return {-x.imag(), x.real(), 0.5 * (n - xx.real()), -0.5 * xx.imag()}; }
  [[nodiscard]] ResidualSums residuals(std::size_t j) const {
    return {channels[j].e, -channels[j].ex.imag(), channels[j].ex.real(), channels[j].ee};
  }
};

struct Block {
  DesignSeries design;
  std::vector<ResidualSeries> channels;
  double half_length_s = 0.0;
};

} // namespace kernel

class SineStream::State {
public:
  static constexpr std::size_t block_length = 64;

  State(const Frequency& frequency, std::size_t channels) : frequency_(frequency), values_(channels), start_(channels) {
    totals_.channels.resize(channels);
  }

  Expected<void> push(std::span<const std::int64_t> stamps, std::span<const std::span<const double>> channels);
  [[nodiscard]] std::uint64_t samples() const { return static_cast<std::uint64_t>(totals_.n) + filled_; }
  [[nodiscard]] Expected<std::vector<SineFit>> fit(std::int64_t reference_ns) const;
  [[nodiscard]] Expected<FrequencyFit> fit_with_frequency(double search_rel, std::int64_t reference_ns) const;

private:
  [[nodiscard]] Expected<void> check(std::span<const std::int64_t> stamps, std::span<const std::span<const double>> channels) const;
  [[nodiscard]] Expected<void> ready(std::size_t parameters) const;
  [[nodiscard]] Expected<std::int64_t> shift_to(std::int64_t reference_ns) const;
  [[nodiscard]] kernel::Block reduce() const;
  void add_open_block(kernel::Totals& totals) const;
  [[nodiscard]] std::size_t without_gap(std::span<const std::int64_t> stamps);
  void close_block();
  void choose_start();
  [[nodiscard]] double span_s() const { return static_cast<double>(last_ns_ - first_ns_) * 1e-9; }
  [[nodiscard]] double search(std::span<const kernel::Segment> segments, double half_range) const;
  void add_spectra(std::span<const kernel::Segment> segments, double step, int half, std::vector<double>& merit) const;
  [[nodiscard]] double misfit(std::span<const kernel::Segment> segments, double delta, kernel::ShiftedSums& sums) const;

  Frequency frequency_;
  std::array<std::int64_t, block_length> stamps_{};
  std::vector<std::array<double, block_length>> values_;
  std::size_t filled_ = 0;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::int64_t last_interval_ns_ = std::numeric_limits<std::int64_t>::max();
  std::vector<kernel::Parameters> start_; // about the first stamp
  kernel::Totals totals_;
  std::deque<kernel::Block> blocks_;
  double highest_rate_hz_ = 0.0; // mean of a block
};

} // namespace dyncal::analysis
