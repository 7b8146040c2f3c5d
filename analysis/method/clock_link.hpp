// Two links between the clocks of reference and sensor, and what both together say: sync, which
// both record, and stamps that both have in UTC.
//
//   x = t_dau - t_acs - (arg P_sync_dau,true - arg P_sync_acs) / w   modulo a period
//
// is by how much the sensor's clock shows an instant later than that of the reference, by sync; by
// their stamps 0. P are about t_acs and t_dau, each in its own clock. A response that sync links,
// times exp(-i W w x), has the weight W of the stamps:
//
//   W = u^2(sync) / (u^2(sync) + u^2(stamps)),   u(x)^2 = u^2(sync) + u^2(stamps)
//
// What sync contributes to the budget then counts 1 - W times, the stamps W times. Two links that
// are more than 2 u(x) apart contradict each other: then U holds either of them. Any thread.
#pragma once

#include <complex>
#include <optional>

#include "analysis/method/channels_of_one_clock.hpp"
#include "analysis/uncertainty/budget.hpp"

namespace dyncal::analysis {

struct ClockLink {
  double offset_s = 0.0; // x
  double u_sync_s = 0.0;
  double u_stamps_s = 0.0;

  [[nodiscard]] double u_offset_s() const;
  [[nodiscard]] double weight_of_stamps() const; // W
  [[nodiscard]] std::complex<double> factor(double angular_hz) const;
  // Standard uncertainty of the time that both together give, for the part of the stamps.
  [[nodiscard]] double u_by_stamps_s() const;
};

// `u_stamps_s`: between the two clocks. `sync_rows`: all that sync contributes.
// `sync_dau_lag_rad`: of the ADC that records the sensor's sync.
[[nodiscard]] ClockLink link_of_clocks(const RecordedChannel& sync_acs,
                                       const RecordedChannel& sync_dau, double sync_dau_lag_rad,
                                       const Budget& sync_rows, double u_stamps_s);

// 1 - W times the rows of sync; all of them where it is the only link.
[[nodiscard]] Budget as_far_as_sync_counts(const Budget& sync_rows,
                                           const std::optional<ClockLink>& link);

} // namespace dyncal::analysis
