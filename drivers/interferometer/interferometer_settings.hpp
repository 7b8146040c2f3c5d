// What is stated of a laser interferometer whose two quadrature signals are channels of a device.
// Plain data; any thread.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "analysis/interferometer/ellipse.hpp"
#include "analysis/interferometer/ellipse_moments.hpp"
#include "analysis/interferometer/radius_over_phase.hpp"

namespace dyncal::drivers::interferometer {

// Known beforehand, in the unit of the channels. Errors of the phase in radians, as
// drivers/quadrature_signals.hpp has them.
struct StatedEllipse {
  analysis::Ellipse ellipse;
  std::array<double, 2> u_rad{};
  std::optional<std::array<double, analysis::radius_orders>> periodic_error_rad{};
  double turns_covered = 0.0; // of the record that it is from; 0: not known
  std::string from{};         // in words
};

struct InterferometerSettings {
  std::string u1; // channels, as they are named
  std::string u2;
  std::string channel = "displacement"; // that is made of them
  double displacement_per_turn_m = 0.0; // its sign is the direction
  double u_wavelength_rel = 0.0;
  std::optional<StatedEllipse> ellipse{};        // empty: of the running signals
  std::optional<double> detector_bandwidth_hz{}; // empty: fast enough not to matter
  double u_skew_s = 0.0;
  std::optional<double> output_rate_hz{}; // empty: the highest up to 100 kS/s
  std::filesystem::path record{};         // folder for the raw pairs; empty: none
  // In place of what the device says of its channels; low == high: none.
  std::optional<analysis::SignalRange> range_u1{};
  std::optional<analysis::SignalRange> range_u2{};
};

inline constexpr double highest_usual_rate_hz = 100'000.0;
inline constexpr std::size_t largest_factor = 512; // of one filter

// Of which samples one is published; nothing where the rate is no whole multiple of the output's,
// up to 512 times.
[[nodiscard]] inline std::optional<std::size_t> factor_of(double rate_hz,
                                                          const InterferometerSettings& settings) {
  constexpr double rounding = 1e-9;
  if (!settings.output_rate_hz) {
    const double factor = std::ceil(rate_hz / highest_usual_rate_hz * (1.0 - rounding));
    return static_cast<std::size_t>(std::clamp(factor, 1.0, static_cast<double>(largest_factor)));
  }
  const double ratio = rate_hz / *settings.output_rate_hz;
  const double whole = std::round(ratio);
  const bool is_whole = whole >= 1.0 && whole <= static_cast<double>(largest_factor) &&
                        std::abs(ratio - whole) <= rounding * ratio;
  return is_whole ? std::optional(static_cast<std::size_t>(whole)) : std::nullopt;
}

} // namespace dyncal::drivers::interferometer
