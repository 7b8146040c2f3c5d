// From signals to the phasors of acceleration and sync, for tests.
#pragma once

#include <complex>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/interferometer/quadrature_phase.hpp"
#include "analysis/interferometer/reference_motion.hpp"
#include "analysis/sine/equidistant_axis.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis::simulated {

struct ChainResult {
  std::complex<double> acceleration; // m/s^2, about the first sample
  std::complex<double> sync;
  double u_magnitude_rel = 0.0;
  double u_phase_rad = 0.0;
  PhaseStatistics phase;
};

// About an instant that lies `earlier_rad` before that of the fit.
inline std::complex<double> phasor_before(const SineFit& fit, double earlier_rad) {
  return std::complex<double>(fit.sine, fit.cosine) * std::polar(1.0, -earlier_rad);
}

inline std::optional<ChainResult> chain(const MotionSettings& settings, const Ellipse& ellipse,
                                        std::span<const std::int16_t> u1,
                                        std::span<const std::int16_t> u2,
                                        std::span<const double> sync) {
  QuadraturePhase phase(ellipse);
  std::vector<double> turns(u1.size());
  auto motion = ReferenceMotion::of_step(settings);
  if (!motion || !phase.push(u1, u2, turns)) {
    ADD_FAILURE() << "no phase";
    return std::nullopt;
  }
  motion->push_turns(turns);
  motion->push_sync(sync);
  const auto decimated = motion->decimated();
  if (!decimated) {
    ADD_FAILURE() << decimated.error().message;
    return std::nullopt;
  }
  const EquidistantAxis axis(decimated->interval_s);
  const auto stamps = axis.stamps_ns(decimated->sync.size());
  const std::span<const double> channels[] = {decimated->acceleration_m_s2, decimated->sync};
  const auto fits = fit_sine(axis.on_axis(settings.frequency_hz), 0, stamps, channels);
  if (!fits) {
    ADD_FAILURE() << fits.error().message;
    return std::nullopt;
  }
  const SineFit& acceleration = (*fits)[0];
  const double earlier_rad = 2.0 * std::numbers::pi * settings.frequency_hz * decimated->first_s;
  return ChainResult{
      phasor_before(acceleration, earlier_rad), phasor_before((*fits)[1], earlier_rad),
      decimated->noise_factor * acceleration.u_amplitude() / acceleration.amplitude(),
      decimated->noise_factor * acceleration.u_phase_rad(), phase.statistics()};
}

} // namespace dyncal::analysis::simulated
