// Whether the errors of stamps go in step with a sine that is fitted at them.
//
//   y_i = Re(P e^(j w (s_i - e_i))),   s_i: stamp, e_i: its error, small against 1 / w
//
// is fitted at the stamps with
//
//   P' = P (1 - j w <e>) + j w conj(P) E,   E = <e_i e^(-2 j w s_i)>
//
// so that magnitude and phase may be off by w |E|. Of errors that scatter freely |E| is next to
// nothing, but those of ticks of a slow counter are a saw-tooth, and one of its harmonics may fall
// on 2 f: then residuals, scatter and blocks show nothing of it where it beats slowly.
//
// e_i are the distances of the stamps from the line through them, numbered by their intervals. They
// are errors where the sensor samples regularly, and none where its instants are as the stamps say:
// w |E| is a bound, to either side. Any thread.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

// |E| in seconds; 0 where errors that scatter freely give as much once in 10^5, and where intervals
// do not tell the numbers of the samples. REQUIRES: increasing stamps.
[[nodiscard]] double stamp_beat_s(const Frequency& frequency,
                                  std::span<const std::int64_t> stamps_ns);

} // namespace dyncal::analysis
