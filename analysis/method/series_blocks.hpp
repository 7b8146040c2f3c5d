// Do the series of repeated shots hold one steady sine each, and the same sample rate in all?
//
// Every series is divided into K = 4..15 blocks of whole periods. What a block leaves of the sine
// that was fitted to its series at the common frequency, e, gives its phase and magnitude against
// it:
//
//   d_jk = 2 / (n A_j) sum e cos(w t + theta_j)     m_jk = 2 / (n A_j) sum e sin(w t + theta_j)
//
// of standard uncertainty s sqrt(2 / n) / A, s being the noise within blocks; or more where
// neighbouring blocks scatter by more (median of second differences, 5 % of which a lost sample
// spoils). A series of another rate than the mean has a slope, one whose clock drifts is bent, one
// that lost a sample has a step.
//
// A finding is what chance brings once in 10 000 (chi-squared, Wilson and Hilferty): slopes that
// differ from shot to shot; phases beyond offset and slope of their shot, in all together or in one
// alone; phases or magnitudes that change alike in all shots. Magnitudes that change differently
// are none, for the exciter may wander.
//
// `turn_rad`: where slopes differ, what each shot's own slope turns its first sample by. What bends
// all series alike (orders 2 and 3 of the time, above two standard uncertainties) moves the first
// sample by `u_phase_rad`.
//
// Empty where a series has fewer than four periods, or fewer than eight samples a block. Any
// thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

// What bends all series of a step alike, in orders 2 and 3 of the time.
struct SeriesBend {
  std::array<double, 2> turn_rad{}; // of the first sample
  std::array<double, 2> u_rad{};
};

struct SeriesAgreement {
  bool rates_differ = false;
  bool phases_change = false;      // in a shot or in all, other than by a rate
  bool magnitudes_change = false;  // alike in all shots
  std::vector<double> turn_rad;    // of each shot; empty where rates do not differ
  double u_turn_rad = 0.0;         // of one of them
  double u_phase_rad = 0.0;        // of the first sample, common to all shots
  SeriesBend bend;                 // what that is made of
  double rate_scatter_rel = 0.0;   // between shots, where rates differ, as it counts in a mean
  double largest_change_rad = 0.0; // of one block against its shot

  [[nodiscard]] bool any() const { return rates_differ || phases_change || magnitudes_change; }
};

// `fits` about stamp 0, of `series`; all are of one length, and `stamps_ns` begin at 0.
[[nodiscard]] std::optional<SeriesAgreement>
compare_series(const Frequency& frequency, std::span<const std::int64_t> stamps_ns,
               std::span<const std::span<const double>> series, std::span<const SineFit> fits);

} // namespace dyncal::analysis
