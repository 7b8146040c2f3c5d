// Rows of what errors of stamps that are in step with the signal may do to a value
// (clock/stamp_beat.hpp): bounds to either side, u is 1 / sqrt(3) of them.
//
//   in step      |B| of magnitude and phase, drawn anew in every repetition
//   on average   w |<e>| of the phase, which all repetitions may share
//
// Channels with the same stamps have <e> in common, and B but for what their phases differ by:
// their ratio is off by 2 |sin(phi_1 - phi_2)| |B| at most. Any thread.
#pragma once

#include <string>

#include "analysis/clock/stamp_beat.hpp"
#include "analysis/uncertainty/budget.hpp"

namespace dyncal::analysis {

// What of it a value takes over.
struct BeatReach {
  double in_step_magnitude = 1.0;
  double in_step_phase = 1.0;
  double on_average = 1.0;
};

[[nodiscard]] BeatReach reach_on_ratio(double phase_rad, double other_phase_rad);

// Nothing where the bound is 0. `whose` stamps: "the sensor".
void add_beat_rows(Budget& budget, const std::string& whose, double angular_frequency,
                   const StampBeat& beat, const BeatReach& reach);

} // namespace dyncal::analysis
