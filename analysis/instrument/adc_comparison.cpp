#include "analysis/instrument/adc_comparison.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <string>

namespace dyncal::analysis {
namespace {

constexpr double turn_rad = 2.0 * std::numbers::pi;

std::complex<double> phasor_of(const SyncPhasor& sync) {
  return {sync.sine, sync.cosine};
}

double u_amplitude_rel(const SyncPhasor& sync) {
  return std::hypot(sync.sine * sync.u_sine, sync.cosine * sync.u_cosine) /
         std::norm(phasor_of(sync));
}

double u_phase_rad(const SyncPhasor& sync, double away_s) {
  const double of_fit =
      std::hypot(sync.cosine * sync.u_sine, sync.sine * sync.u_cosine) / std::norm(phasor_of(sync));
  return std::hypot(of_fit, turn_rad * sync.u_frequency_hz * away_s);
}

bool usable(const SyncPhasor& sync) {
  const double amplitude = std::abs(phasor_of(sync));
  return amplitude > 0.0 && std::isfinite(amplitude) && sync.frequency_hz > 0.0;
}

} // namespace

Expected<AdcComparison> compare_sync_adc(const SyncPhasor& acs, const SyncPhasor& dau,
                                         double max_apart_s,
                                         const AdcComparisonUncertainty& uncertainty) {
  if (!usable(acs) || !usable(dau)) {
    return fail(ErrorCode::invalid_argument, "a sync signal has no amplitude or no frequency");
  }
  const double apart_s = static_cast<double>(dau.phase_origin_ns - acs.phase_origin_ns) * 1e-9;
  if (!(std::abs(apart_s) <= max_apart_s)) {
    return fail(ErrorCode::invalid_argument,
                "the records of the two systems lie " + std::to_string(apart_s) +
                    " s apart: their stamps are not on one time scale");
  }
  const double half_s = 0.5 * apart_s; // from the ACS's instant onwards, from the DAU's back
  const double phase_rad = std::arg(phasor_of(dau)) - turn_rad * dau.frequency_hz * half_s -
                           std::arg(phasor_of(acs)) - turn_rad * acs.frequency_hz * half_s;
  const double w = turn_rad * acs.frequency_hz;
  AdcComparison comparison;
  comparison.point.frequency_hz = acs.frequency_hz;
  comparison.point.gain = std::abs(phasor_of(dau)) / std::abs(phasor_of(acs));
  comparison.point.phase_lag_rad = std::remainder(-phase_rad, turn_rad);
  comparison.point.u_gain = comparison.point.gain * uncertainty.acs_gain_rel;
  comparison.point.u_phase_lag_rad =
      w * std::hypot(uncertainty.time_scale_s, uncertainty.acs_delay_s);
  comparison.noise_gain =
      comparison.point.gain * std::hypot(u_amplitude_rel(acs), u_amplitude_rel(dau));
  comparison.noise_phase_rad = std::hypot(u_phase_rad(acs, half_s), u_phase_rad(dau, half_s));
  comparison.sync_vpp = 2.0 * std::abs(phasor_of(acs));
  comparison.point.test_amplitude_vpp = comparison.sync_vpp;
  return comparison;
}

} // namespace dyncal::analysis
