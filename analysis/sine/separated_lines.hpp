// The lines of a multi-sine in a record, fitted together, and the record of each line alone.
//
//   y(t) = C + d_1 u + d_2 u^2 + sum_k (A_k sin(w_k (t - t_0)) + B_k cos(w_k (t - t_0))) + e
//
// One least squares fit of all lines (extended_sine_fit.hpp), t_0 the middle of the record. What
// it leaves, e, is orthogonal to all lines: fitted to the record of line k alone,
//
//   y_k(t) = C + d_1 u + d_2 u^2 + A_k sin(w_k (t - t_0)) + B_k cos(w_k (t - t_0)) + e
//
// a sine of w_k has the A_k and B_k of the joint fit. Whatever evaluates a record with one sine
// evaluates a line so, with its noise, hum and drift as they are. What it does not know is how far
// the other lines widen its covariance: `widening`, the u of the joint fit over that of one sine in
// the same noise, 1 in whole periods. A record in which it exceeds 1.1 is too short to tell its
// lines apart (ill_conditioned); for the clock of a record it may be 3 (LinesMayOverlap).
//
// Fails as extended_sine_fit.hpp does otherwise. REQUIRES: two lines. Any thread; the samples must
// outlive it.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct LinePhasor {
  std::complex<double> phasor; // A + iB
  double u_component = 0.0;    // of A and of B, white noise
};

enum class LinesMayOverlap { hardly, somewhat };

class SeparatedLines {
public:
  [[nodiscard]] static Expected<SeparatedLines>
  make(std::span<const Frequency> lines, std::span<const std::int64_t> stamps_ns,
       std::span<const std::span<const double>> channels,
       LinesMayOverlap overlap = LinesMayOverlap::hardly);

  [[nodiscard]] std::int64_t origin_ns() const { return origin_ns_; } // t_0
  [[nodiscard]] const LinePhasor& at(std::size_t line, std::size_t channel) const {
    return channels_[channel].lines[line];
  }
  [[nodiscard]] double residual_sd(std::size_t channel) const {
    return channels_[channel].residual_sd;
  }
  // The values without any line: e, with offset and drift.
  [[nodiscard]] std::span<const double> rest(std::size_t channel) const {
    return channels_[channel].rest;
  }
  // y_k
  [[nodiscard]] std::vector<double> only(std::size_t line, std::size_t channel) const;

private:
  struct Channel {
    std::vector<LinePhasor> lines;
    std::vector<double> rest;
    double residual_sd = 0.0;
  };

  SeparatedLines(std::span<const Frequency> lines, std::span<const std::int64_t> stamps_ns);
  void add_line(std::size_t line, std::complex<double> phasor, std::span<double> values) const;

  std::vector<Frequency> frequencies_;
  std::span<const std::int64_t> stamps_ns_;
  std::int64_t origin_ns_;
  std::vector<Channel> channels_;
};

} // namespace dyncal::analysis
