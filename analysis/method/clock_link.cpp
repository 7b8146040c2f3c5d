#include "analysis/method/clock_link.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::analysis {
namespace {

constexpr double contradiction = 2.0; // u(x)

} // namespace

double ClockLink::u_offset_s() const {
  return std::hypot(u_sync_s, u_stamps_s);
}

double ClockLink::weight_of_stamps() const {
  const double sync = u_sync_s * u_sync_s;
  return sync > 0.0 ? sync / (sync + u_stamps_s * u_stamps_s) : 0.0;
}

std::complex<double> ClockLink::factor(double angular_hz) const {
  return std::polar(1.0, -weight_of_stamps() * angular_hz * offset_s);
}

double ClockLink::u_by_stamps_s() const {
  const double weight = weight_of_stamps();
  const double either = 0.5 * std::max(weight, 1.0 - weight) * std::abs(offset_s);
  return std::hypot(weight * u_stamps_s,
                    std::abs(offset_s) > contradiction * u_offset_s() ? either : 0.0);
}

ClockLink link_of_clocks(const RecordedChannel& sync_acs, const RecordedChannel& sync_dau,
                         double sync_dau_lag_rad, const Budget& sync_rows, double u_stamps_s) {
  const ChannelFit& acs = sync_acs.result;
  const ChannelFit& dau = sync_dau.result;
  const double w = dau.frequency.angular();
  constexpr double turn = 2.0 * std::numbers::pi;
  const double between = dau.frequency.reduced_turns(dau.phase_origin_ns - acs.phase_origin_ns);
  const double later = (dau.fit.phase_rad() + sync_dau_lag_rad - acs.fit.phase_rad()) / turn;
  return {.offset_s = turn * std::remainder(between - later, 1.0) / w,
          .u_sync_s = sync_rows.u_phase_rad() / w,
          .u_stamps_s = u_stamps_s};
}

Budget as_far_as_sync_counts(const Budget& sync_rows, const std::optional<ClockLink>& link) {
  if (!link) {
    return sync_rows;
  }
  Budget budget;
  for (Contribution row : sync_rows.rows()) {
    row.u_phase_rad *= 1.0 - link->weight_of_stamps();
    budget.add(row);
  }
  return budget;
}

} // namespace dyncal::analysis
