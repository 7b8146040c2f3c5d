// Whether the clocks of a run are clocks: the rate of one against the other, that ratio in every
// step against all others, and the frequency that was fitted against the one that was asked for.
//
//   r_i = f_i,ACS / f_i,DAU - 1       of sync in step i, each in its own clock
//   d_i = r_i - mean of the other r   against Student's t at n - 2 degrees of freedom
//   lambda - 1                        of a triggered series: real rate over nominal rate
//   f_i,ACS / f_i,asked - 1
//   lambda_k / lambda_l - 1           of two channels of a series, each by its own samples, in the
//                                     step in which they differ most
//   x_i                           of sync against UTC (clock_link.hpp), in the step where it is
//                                 known best; open where |E_n| = |x| / (2 u) is above 2
//
// Tolerances: crystals of instruments are right to the recipe's clock_tolerance_rel (200 ppm), an
// oscillator within a sensor to 5 %; while they warm up, they wander by 1 ppm. Steps with a hundred
// times less scatter than that are no finding. Plain functions, any thread.
#pragma once

#include <vector>

#include "services/evaluation/closures/channel_run.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] std::vector<Closure> clock_closures(const ChannelRun& run);

// Of two channels of one source.
[[nodiscard]] Closure clocks_of_channels(const ChannelRun& one, const ChannelRun& other);

} // namespace dyncal::inline evaluation
