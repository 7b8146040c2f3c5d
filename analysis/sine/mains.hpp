// Frequencies of the mains whose lines are looked for, unless a bench file lists others: those of
// the public grids. Railways have 16.7 Hz, aircraft 400 Hz.
#pragma once

#include <array>

namespace dyncal::analysis {

inline constexpr std::array usual_mains_hz{50.0, 60.0};

} // namespace dyncal::analysis
