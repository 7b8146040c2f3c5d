// Whether the phases of a run are those of a sensor: on a line with the group delay as its slope,
// which other slopes the frequencies leave open, whether that line begins at 0 or pi, and whether
// channels of one kind have one delay.
//
//   sqrt(chi^2 / nu) / q             residuals from the line, over the whole u of the phases, which
//                                    is q times the part that the line was weighted with
//   psi_0 modulo pi                  against u(psi_0); not possible where sensor and reference are
//                                    of two kinds, as a coil beside a displacement
//   dtau = -sum w_f dpsi_f / u_f^2 / sum w_f^2 / u_f^2     dpsi: of two channels in one step, in
//                                    which all that both share cancels; within half a sample
//                                    interval, as of axes that a sensor converts in turn
//
// Plain functions, any thread.
#pragma once

#include <vector>

#include "services/evaluation/closures/channel_run.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] std::vector<Closure> phase_closures(const ChannelRun& run);

// Of two channels of one source and one unit.
[[nodiscard]] Closure delays_of_channels(const ChannelRun& one, const ChannelRun& other);

} // namespace dyncal::inline evaluation
