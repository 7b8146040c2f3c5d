// Whether the samples of a channel in a step are what its sensor felt: end stops, stuck values,
// distortion (analysis/step/signal_integrity.hpp), against the range and the resolution that the
// channel's description states.
//
// Gives numbers, flags, and a refusal where no uncertainty covers what was lost: a value that hides
// clipping or stuck samples of more than a thousandth. A channel without a sine that stands out of
// its noise has no numbers; one that cannot be judged for another reason has a flag that gives it.
// Plain functions, any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "analysis/method/transfer_point.hpp"
#include "drivers/sample_block.hpp"
#include "services/evaluation/method/selected_channels.hpp"
#include "services/evaluation/result/channel_signal.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::services {

struct SignalCheck {
  ChannelSignal signal;
  std::vector<Flag> flags;
  std::string refusal; // one sentence; empty: the value stands
};

// `fit`: the sine that was fitted to the channel; `description`: its range and resolution.
[[nodiscard]] SignalCheck check_signal(const analysis::ChannelFit& fit,
                                       std::span<const std::int64_t> stamps_ns,
                                       std::span<const double> values,
                                       const drivers::ChannelDescription& description);

// Channel `index` of what was selected.
[[nodiscard]] SignalCheck check_signal(const analysis::ChannelFit& fit,
                                       const SelectedChannels& selected, std::size_t index);

} // namespace dyncal::services
