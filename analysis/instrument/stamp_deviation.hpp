// How far the time stamps of a DAU are from the true seconds of a reference pulse (paper section
// 2.2 and figure 2).
//
// The unit stamps an edge captured at the counter reading r from its GPS pulses c_i (second s_i),
// as its firmware does; the reference pulse n comes at the true time n + o:
//
//   t   = s_i + (r - c_i) / m          i: the latest GPS edge before r
//   d_n = t_n - n - o                  positive: the stamp is too late
//   p_i = (c_i - c_{i-1}) / m - 1      GPS pulses against the counter, without any reference
//
// m is the mean of the last 60 differences c_j - c_{j-1} in ticks per second; edges with fewer than
// two of them are not judged. o, the delay of the reference pulse at the unit's inputs, is given,
// and then the mean of d is a result; otherwise o is the mean of t_n - n, and only changes of d are
// known.
//
// u(mean) is the largest standard deviation of the mean over blocks of 1, 2, 4 ... deviations with
// at least 16 blocks, since d wanders (Flyvbjerg, Petersen, J. Chem. Phys. 91 (1989) 461). n_eff =
// sd^2 / u^2(mean) gives u(sd) = sd / sqrt(2 (n_eff - 1)). Drift: one slope over all sessions, each
// with its own constant, u enlarged by sqrt(n / n_eff). Allan deviation: d as time error on the
// longest stretch without a missing second. One stamp with the mean corrected has u^2 = sd^2 +
// u^2(mean) + u^2(o).
//
// Fails: too_few_samples (fewer than three reference edges with a stamp), invalid_argument. Any
// thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/clock/allan_deviation.hpp"
#include "analysis/instrument/pulse_edges.hpp"

namespace dyncal::analysis {

struct StampDeviationSettings {
  std::optional<double> reference_offset_s; // o
  double u_reference_s = 0.0;               // u(o)
};

struct StampDeviation {
  std::size_t session = 0;
  double time_s = 0.0; // in the record; the unknown time between two sessions counts as one second
  double deviation_s = 0.0; // d
  std::size_t edge = 0;     // of the record
};

struct PulsePrediction { // p of all sessions
  std::size_t count = 0;
  double sd_s = 0.0;
  double minimum_s = 0.0;
  double maximum_s = 0.0;
  double ticks_per_second = 0.0; // mean
  double sd_ticks = 0.0;         // of one second
};

struct StampDeviationStatistics {
  std::vector<StampDeviation> deviations;
  std::size_t untrusted =
      0; // reference edges at which the unit had no two figures of its counter yet
  double reference_offset_s = 0.0;
  double mean_s = 0.0;
  double u_mean_s = 0.0; // contains u(o)
  double sd_s = 0.0;
  double u_sd_s = 0.0;
  double minimum_s = 0.0;
  double maximum_s = 0.0;
  double quantile_025_s = 0.0;
  double quantile_975_s = 0.0;
  double effective_count = 0.0;
  double drift = 0.0; // s/s
  double u_drift = 0.0;
  double u_stamp_s = 0.0;
  std::vector<AllanPoint> allan;
};

// Nothing when there are no three GPS edges in one session.
[[nodiscard]] std::optional<PulsePrediction> predict_gps_pulses(const SortedPulses& pulses);

[[nodiscard]] Expected<StampDeviationStatistics>
stamp_deviations(const SortedPulses& pulses, const StampDeviationSettings& settings = {});

} // namespace dyncal::analysis
