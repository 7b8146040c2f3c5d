// Whether what was recorded is what was asked for: the level of the excitation, and the number of
// samples against the time that they took.
//
//   a_i / level_i - 1                   a_i: amplitude of the reference, in m/s^2
//   N_i - (1 + (t_last - t_first) F)    N_i: used and left out or lost, F: usual rate of the run;
//                                       what was left out may lie beside the two instants
//
// The level is off where the recipe's level_deviation_rel says so. Two samples are what the ends of
// an evaluated part leave open, and more where the stamps of all steps scatter by more. Plain
// functions, any thread.
#pragma once

#include <vector>

#include "services/evaluation/closures/channel_run.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] std::vector<Closure> record_closures(const ChannelRun& run);

} // namespace dyncal::inline evaluation
