// How far the start of triggered series may scatter in a whole run: the sensor is one device, so
// all steps tell of the same scatter, also those whose own shots hide it in their noise.
//
//   x_ij ~ N(m_i, u_i^2 + s^2)          when shot j of step i began; s is common to all steps
//   t_i(s) = S_i / u_i^2 r / (1 + r) - (n_i - 1) log(1 + r)
//                                       r = s^2 / u_i^2, S_i = sum_j (x_ij - mean)^2
//
// t is twice the logarithm of the likelihood against s = 0, from the contrasts. No step tells more
// than 20 against an s smaller than its own best: one shot of another trigger does not speak for
// the run, for the other steps exclude so large an s. Before the shots were seen, s is 0 with
// probability 0.6; else its density is that of half a Cauchy distribution of scale 2 u*, where u*
// is what the run resolves, u*^-4 = sum (n_i - 1) / u_i^4. Of the density after they were seen
//
//   u(l)^2 = (2 mean of s)^2 + (4.4 standard deviation of s)^2
//
// holds the mean latency that such a scatter may hide: of a rectangle from 0, the worst case,
// sqrt(3) s, of a start that waits s. Where nothing is shown the second term, what is not known of
// s, makes most of it, 1.8 u*. U holds 95.45 % of rectangles that are not shown, and is at most 1.5
// times what errors of a clean run of three frequencies make it. From one or two steps no rule does
// both; there 3.8 (two) and 2.6 (one) stand for 4.4, so that U of a clean run stays below 1.5
// times, and holds 87 to 98 % of rectangles that are not shown. The scatter is shown where the sum
// over all steps has a maximum above 10: chance, 1e-3.
//
// Plain function, any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace dyncal::analysis {

struct StartEvidence { // of one step
  std::size_t shots = 0;
  double squares_s2 = 0.0; // S_i
  double u_s = 0.0;        // u_i
};

struct SharedStartScatter {
  double scatter_s = 0.0;   // root of the mean of s^2
  double u_latency_s = 0.0; // u(l)
  bool is_shown = false;    // else it may be 0 as well
};

// Empty where no step has two shots.
[[nodiscard]] std::optional<SharedStartScatter>
shared_start_scatter(std::span<const StartEvidence> steps);

} // namespace dyncal::analysis
