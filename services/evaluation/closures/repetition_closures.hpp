// Whether repetitions agree: with each other at every point, with the u of their mean, and the
// first point with itself at the end of the run.
//
//   z_i = |ln|H_i / H_m|| / u, |arg(H_i / H_m)| / u      H_m: the repetition nearest to all others
//
// after what each repetition has in common at all points, its mounting, was taken out
// (mountings.hpp), against s times Student's t; s, at least 1, is the usual z of all points (by its
// median, so that what is wrong does not hide itself), known to as many degrees of freedom as there
// are repetitions beyond one a point, and three of a prior: scatter is seldom many times what
// single results state. Open are single repetitions: inverted, turned, at another level; and all of
// a repetition whose mounting differs by more than mounting_tolerance. They are named, for a flag
// in their own rows.
//
//   sum (n - 1) s_f^2 / (n u_f^2)      chi-squared: scatter that the mean's u does not carry
//
// u_f: of the mean at frequency f, without what all repetitions share. Plain functions, any thread.
#pragma once

#include <vector>

#include "services/evaluation/closures/channel_run.hpp"

namespace dyncal::inline evaluation {

struct RepetitionClosures {
  std::vector<Closure> closures;
  std::vector<const StepResult*> off; // repetitions that do not agree with the others
};

[[nodiscard]] RepetitionClosures repetition_closures(const ChannelRun& run);

} // namespace dyncal::inline evaluation
