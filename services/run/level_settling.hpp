// How long a step settles when its level is brought to the wanted one by closed loop, and how far
// that loop may drive.
//
// The loop's measurements happen before the evaluated part of the step, so the recipe plans time
// for as many as may be needed, in bench time:
//
//   planned settling = settling + n (settling + transport + window + slack)
//
// n: 4 measurements in the first repetition, when the exciter's response at the frequency is not
// known, 2 in later ones. Any thread.
#pragma once

#include "drivers/generator/level_control.hpp"
#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline run {

// Longest way of a sample from the instrument to a reader on DDS.
inline constexpr double level_transport_s = 0.3;
// To look, to set, and for samples that come late.
inline constexpr double level_slack_s = 0.5;

[[nodiscard]] int level_corrections(int repetition);

[[nodiscard]] double planned_settling_s(const BenchFile& bench, double frequency_hz,
                                        int repetition);

// What the bench file states, and what of it a level beyond the highest planned one makes.
[[nodiscard]] drivers::generator::LevelLimits level_limits(const BenchFile& bench);

} // namespace dyncal::inline run
