// What the samples of one channel in one step are like beside the sine that is evaluated, as
// numbers (analysis/step/signal_integrity.hpp). Plain data; any thread.
#pragma once

#include <limits>
#include <string>

namespace dyncal::inline evaluation {

struct ChannelSignal {
  static constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

  std::string channel;           // "source/channel"
  double thd = not_known;        // harmonics 2 to 10 over the amplitude, without those that are
                                 // folded onto the excitation or each other
  double u_thd = not_known;      // what noise alone gives
  double residual = not_known;   // standard deviation of what is left, over the amplitude
  double over_noise = not_known; // the same over the white noise of neighbouring samples
};

} // namespace dyncal::inline evaluation
