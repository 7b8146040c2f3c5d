// Amplitudes (zero to peak) of a sinusoidal motion, of which each gives the others:
//
//   a = omega v = omega^2 d,   omega = 2 pi f
//
// Any thread.
#pragma once

#include <numbers>

namespace dyncal::analysis {

[[nodiscard]] constexpr double angular_frequency(double frequency_hz) {
  return 2.0 * std::numbers::pi * frequency_hz;
}

[[nodiscard]] constexpr double acceleration_of_velocity_m_s2(double velocity_m_s,
                                                             double frequency_hz) {
  return velocity_m_s * angular_frequency(frequency_hz);
}

[[nodiscard]] constexpr double acceleration_of_displacement_m_s2(double displacement_m,
                                                                 double frequency_hz) {
  return displacement_m * angular_frequency(frequency_hz) * angular_frequency(frequency_hz);
}

[[nodiscard]] constexpr double velocity_m_s(double acceleration_m_s2, double frequency_hz) {
  return acceleration_m_s2 / angular_frequency(frequency_hz);
}

[[nodiscard]] constexpr double displacement_m(double acceleration_m_s2, double frequency_hz) {
  return velocity_m_s(acceleration_m_s2, frequency_hz) / angular_frequency(frequency_hz);
}

} // namespace dyncal::analysis
