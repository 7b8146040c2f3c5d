// Whether the samples of a channel in a step are what its sensor felt: end stops, stuck values,
// distortion (analysis/step/signal_integrity.hpp), against the range and the resolution that the
// channel's description states.
//
// Gives numbers, flags, and a refusal where no uncertainty covers what was lost: a value that hides
// clipping or stuck samples of more than a thousandth. A channel without a sine that stands out of
// its noise has no numbers; one that cannot be judged for another reason has a flag that gives it.
// Plain functions, any thread.
#pragma once

#include <string>
#include <vector>

#include "analysis/method/transfer_point.hpp"
#include "drivers/sample_block.hpp"
#include "services/evaluation/result/channel_signal.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::inline evaluation {

struct SignalCheck {
  ChannelSignal signal;
  std::vector<Flag> flags;
  std::string refusal; // one sentence; empty: the value stands
};

// Of the channel as it was fitted: nothing to say where no sine stands out of it.
[[nodiscard]] SignalCheck check_signal(const analysis::ChannelFit& fit);

// Of what was measured, or the reason why it could not be.
[[nodiscard]] SignalCheck
check_signal(const std::string& channel,
             const analysis::Expected<analysis::SignalIntegrity>& integrity);

// The range and the resolution that the description states.
[[nodiscard]] analysis::SignalExpectation
expectation_of(const drivers::ChannelDescription& description);

} // namespace dyncal::inline evaluation
