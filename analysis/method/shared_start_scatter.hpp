// How far the start of triggered series scatters in a whole run: the sensor is one device, so all
// steps tell of the same scatter, also those whose own shots hide it in their noise.
//
//   x_ij ~ N(m_i, u_i^2 + s^2)          when shot j of step i began; s is common to all steps
//   t_i(s) = S_i / u_i^2 r / (1 + r) - (n_i - 1) log(1 + r)
//                                       r = s^2 / u_i^2, S_i = sum_j (x_ij - mean)^2
//
// t is twice the logarithm of the likelihood against s = 0, from the contrasts. No step counts for
// more than 7: one shot of another trigger seldom speaks for the run. There is scatter where the
// sum over all steps has a maximum above 10, which chance brings once in 1000; s is the largest
// whose sum is within 1 of the maximum.
//
// What scatters hides a mean latency, which no shot shows (start_latency.hpp): s for one that
// waits, sqrt(3) s for a rectangle, none for jitter; each as likely, u(l) = sqrt(4 / 3) s.
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
  double scatter_s = 0.0;   // s
  double u_latency_s = 0.0; // u(l)
};

[[nodiscard]] std::optional<SharedStartScatter>
shared_start_scatter(std::span<const StartEvidence> steps);

} // namespace dyncal::analysis
