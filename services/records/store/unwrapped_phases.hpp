// The phases of calibrations over frequency without jumps of a turn, for figures that lay them over
// each other: each channel is followed from frequency to frequency
// (analysis/instrument/curve_between_points.hpp), later calibrations as near to the first one of
// the channel as whole turns bring them. Plain function, any thread.
#pragma once

#include <vector>

#include "services/records/store/store.hpp"

namespace dyncal::inline records {

// Sets `unwrapped_phase_rad` of every point whose phase is known.
void unwrap_phases(std::vector<Calibration>& calibrations);

} // namespace dyncal::inline records
