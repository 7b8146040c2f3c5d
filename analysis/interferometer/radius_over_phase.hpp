// How the radius of the corrected signals changes with the phase: what an ellipse cannot correct.
//
//   rho(phi) = rho_0 + sum_k rho_k cos(k phi - psi_k),   k = 1..4
//
// The squares of the radius are averaged in 256 sectors of the phase, and the harmonics fitted to
// the roots of these averages (least squares, sectors weighted by their samples). A radius that
// changes with k phi goes with a phase error of amplitude rho_k / R and the same order: third-order
// saturation of both photodiodes has k = 4, and remains whole after the correction by Heydemann.
//
// Blocks and records add up. Harmonics are given where all but a sixteenth of the sectors have been
// visited; on a shorter arc they cannot be told from each other. Any thread, no synchronisation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "analysis/interferometer/ellipse.hpp"

namespace dyncal::analysis {

inline constexpr std::size_t radius_sectors = 256;
inline constexpr std::size_t radius_orders = 4;
inline constexpr std::size_t radius_parts = 64; // of the turn, for a picture

struct RadiusHarmonics {
  double mean = 0.0;                             // rho_0
  std::array<double, radius_orders> amplitude{}; // rho_1 .. rho_4
};

class RadiusOverPhase {
public:
  // The phase in turns, in [-0.5, 0.5].
  void add(double turns, double radius_squared) {
    Sector& sector =
        sectors_[static_cast<std::size_t>((turns + 0.5) * radius_sectors) % radius_sectors];
    sector.squares += radius_squared;
    ++sector.samples;
  }
  void add(const RadiusOverPhase& other);

  // Root mean square of the radius in a sector that begins at -0.5 + sector / 256 turns; empty
  // where no sample was.
  [[nodiscard]] std::optional<double> radius(std::size_t sector) const;
  [[nodiscard]] std::optional<RadiusHarmonics> harmonics() const;
  // Of 64 parts of the turn from phase 0 on, relative to rho_0. Empty: one has not been visited.
  [[nodiscard]] std::vector<double> deviations() const;

private:
  struct Sector {
    double squares = 0.0;
    std::uint64_t samples = 0;
  };
  std::array<Sector, radius_sectors> sectors_{};
};

// Deviations that were measured with one ellipse, as another one corrects the same signals,
// relative to their mean then; to first order in what the ellipses differ by, which turns the phase
// as well.
[[nodiscard]] std::vector<double> deviations_with(const Ellipse& ellipse,
                                                  const std::vector<double>& measured,
                                                  const Ellipse& measured_with);

} // namespace dyncal::analysis
