// From quadrature signals to displacement: correction by the ellipse, phase, and the whole turns by
// prediction; with what tells whether they are to be trusted.
//
//   s = turns * lambda / (2 N)   lambda in air, N passes; towards growing phase
//
// Unwrapping expects the last step of the phase again: only the second difference must stay below
// half a turn, which asks for fs > sqrt(4 a / lambda) instead of fs > 4 v / lambda (200 m/s^2 at
// 160 Hz: 36 kS/s instead of 1.3 MS/s). Where the signals have fewer than two samples a fringe, the
// velocity at the start is known to whole turns per sample only: a displacement that grows linearly
// is then added, which the second difference (reference_motion.hpp) removes.
//
// Counted are the samples whose step is more than a quarter of a turn from the one expected
// ("doubtful"): near half a turn it slips unnoticed. A better ellipse may be adopted on the way:
// the unwrapped phase goes on from its last value. The radius is averaged over 16 samples before
// its extremes are taken; a detector that is too slow loses radius where the fringes are fast, and
// its delay then depends on the velocity (warn below smallest_radius_ratio).
//
// Samples come in blocks of any size; the result does not depend on how they are cut. Fails:
// not_finite (which sample). No synchronisation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "analysis/base/error.hpp"
#include "analysis/interferometer/ellipse.hpp"
#include "analysis/interferometer/radius_over_phase.hpp"

namespace dyncal::analysis {

inline constexpr double smallest_radius_ratio = 0.9;

struct PhaseStatistics {
  std::uint64_t samples = 0;
  std::uint64_t doubtful = 0;        // samples of a prediction error above a quarter of a turn
  double max_prediction_error = 0.0; // turns, at most 0.5
  double min_turns = std::numeric_limits<double>::infinity();
  double max_turns = -std::numeric_limits<double>::infinity();
  double min_radius_squared = std::numeric_limits<double>::infinity(); // means of 16 samples
  double max_radius_squared = 0.0;

  [[nodiscard]] double turns_covered() const {
    return max_turns > min_turns ? max_turns - min_turns : 0.0;
  }
  // Smallest over largest radius; empty for less than 16 samples.
  [[nodiscard]] std::optional<double> radius_ratio() const;
};

class QuadraturePhase {
public:
  explicit QuadraturePhase(const Ellipse& ellipse) : correction_(correction_of(ellipse)) {}

  // Unwrapped phase in turns. REQUIRES: three spans of one size.
  [[nodiscard]] Expected<void> push(std::span<const std::int16_t> u1,
                                    std::span<const std::int16_t> u2, std::span<double> turns);
  [[nodiscard]] Expected<void> push(std::span<const float> u1, std::span<const float> u2,
                                    std::span<double> turns);
  [[nodiscard]] Expected<void> push(std::span<const double> u1, std::span<const double> u2,
                                    std::span<double> turns);

  // The samples that follow are corrected by another ellipse, whose radius over phase begins anew.
  void adopt(const Ellipse& ellipse);
  // The samples that follow have nothing to do with those before: nothing is expected of the next.
  void begin_again();
  // Extremes of turns and radius are those of the samples that follow.
  void forget_extremes();

  [[nodiscard]] const PhaseStatistics& statistics() const { return statistics_; }
  [[nodiscard]] const RadiusOverPhase& radius_over_phase() const { return radius_over_phase_; }

private:
  template <class Number>
  Expected<void> push_samples(std::span<const Number> u1, std::span<const Number> u2,
                              std::span<double> turns);
  // Wrapped phases in, unwrapped ones out.
  void unwrap(std::span<double> turns);
  Expected<void> see_radius(std::span<const double> turns, const double* radius_squared);

  struct Unwrapping {
    std::uint64_t samples = 0;    // since it began
    double offset = 0.0;          // of the ellipses so far, so that the phase is continuous
    double last_turns = 0.0;      // wrapped
    double last_step = 0.0;       // of wrapped phases
    std::int64_t whole_steps = 0; // whole turns taken off the next step
    std::int64_t whole_turns = 0; // and off the phase
  };

  kernel::QuadratureCorrection correction_;
  PhaseStatistics statistics_;
  RadiusOverPhase radius_over_phase_;
  Unwrapping unwrapping_;
  double last_u1_ = 0.0;
  double last_u2_ = 0.0;
  double radius_sum_ = 0.0;
  unsigned radius_samples_ = 0;
};

// Displacement of one turn.
[[nodiscard]] inline double displacement_per_turn_m(double wavelength_m, int passes) {
  return wavelength_m / (2.0 * passes);
}

} // namespace dyncal::analysis
