// What errors of stamps do to a sine that is fitted at them, where they are in step with it.
//
//   y_i = Re(P e^(j w (s_i - e_i))),   s_i: stamp, e_i: its error
//
// is fitted at the stamps with
//
//   P' = P <e^(-j w e_i)> + conj(P) B,   B = <(e^(j w e_i) - 1) e^(-2 j w s_i)>
//
// so that magnitude and phase may be off by |B| beside what scatter of the stamps shortens
// (sine/stamp_scatter.hpp) and by w <e> in phase. Of errors that scatter freely |B| is next to
// nothing, but those of ticks of a slow counter are a saw-tooth, and one of its harmonics may fall
// on 2 f: then residuals, scatter and blocks show nothing of it where it beats slowly.
//
// e_i are the distances of the stamps from the line through them, numbered by their order or their
// intervals. They are errors where the sensor samples regularly, and none where its instants are as
// the stamps say: |B| is a bound, to either side. Ticks are seen where intervals have but few
// values, at least a thousandth of a period apart; then B counts whatever it is, and <e> is what
// leaves all errors within half a tick, or half a tick where a saw-tooth takes longer than the
// record. Otherwise B counts where errors that scatter freely give as much once in 10^5, and <e>
// does not show. Any thread.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {

struct StampBeat {
  double in_step_rad = 0.0; // |B|
  double mean_s = 0.0;      // most that |<e>| can be
};

// Nothing of fewer than 64 stamps, nor where intervals do not tell the numbers of the samples.
// `stated_tick_s` counts where all intervals are alike, which show none. REQUIRES: increasing
// stamps.
[[nodiscard]] StampBeat stamp_beat(const Frequency& frequency,
                                   std::span<const std::int64_t> stamps_ns,
                                   double stated_tick_s = 0.0);

} // namespace dyncal::analysis
