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

struct ChainSettings {
  double frequency_hz = 0.0;
  double sample_rate_hz = 0.0;
  double displacement_per_turn_m = 0.0; // its sign is the direction
};

inline std::complex<double> phasor_of(const SineFit& fit) {
  return {fit.sine, fit.cosine};
}

inline std::optional<ChainResult> chain(const ChainSettings& settings, const Ellipse& ellipse,
                                        std::span<const std::int16_t> u1,
                                        std::span<const std::int16_t> u2,
                                        std::span<const double> sync) {
  QuadraturePhase phase(ellipse);
  std::vector<double> displacement(u1.size());
  if (!phase.push(u1, u2, displacement)) {
    ADD_FAILURE() << "no phase";
    return std::nullopt;
  }
  for (double& value : displacement) {
    value *= settings.displacement_per_turn_m;
  }
  const EquidistantAxis axis(1.0 / settings.sample_rate_hz);
  const auto stamps = axis.stamps_ns(displacement.size());
  const Frequency frequency = axis.on_axis(settings.frequency_hz);
  const auto motion = motion_of_step(MotionQuantity::displacement, frequency, stamps, displacement);
  if (!motion) {
    ADD_FAILURE() << motion.error().message;
    return std::nullopt;
  }
  const std::span<const double> of_motion[] = {motion->values};
  const std::span<const double> of_sync[] = {sync};
  const auto fit = fit_sine(frequency, 0, motion->stamps_ns, of_motion);
  const auto sync_fit = fit_sine(frequency, 0, stamps, of_sync);
  if (!fit || !sync_fit) {
    ADD_FAILURE() << "no sine";
    return std::nullopt;
  }
  const SineFit& one = fit->front();
  return ChainResult{
      phasor_of(one) * motion_factor(MotionQuantity::displacement, MotionQuantity::acceleration,
                                     2.0 * std::numbers::pi * settings.frequency_hz),
      phasor_of(sync_fit->front()), motion->noise_factor * one.u_amplitude() / one.amplitude(),
      motion->noise_factor * one.u_phase_rad(), phase.statistics()};
}

} // namespace dyncal::analysis::simulated
