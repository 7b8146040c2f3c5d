// A reference that measures displacement or velocity, as the channel of a clock: its sine is fitted
// to the motion of the step alone (reference_motion.hpp), about the instant and in the unit that
// the fit to its samples has. Integrity and scatter of stamps are looked at in the samples without
// slow motion.
//
// Fails as reference_motion.hpp and sine_fit.hpp do; the message names the channel. Any thread.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/base/error.hpp"
#include "analysis/method/channels_of_one_clock.hpp"

namespace dyncal::analysis {

[[nodiscard]] bool is_differentiated(const ChannelSamples& channel);

// `values`: as they came. REQUIRES: is_differentiated(channel.samples).
[[nodiscard]] Expected<void> take_motion(std::span<const double> values, RecordedChannel& channel);

struct MotionFrequency {
  Frequency frequency;
  double u_frequency_hz = 0.0;
};

// REQUIRES: is_differentiated(channel).
[[nodiscard]] Expected<MotionFrequency> frequency_of_motion(const Frequency& nominal,
                                                            double frequency_search_rel,
                                                            std::span<const std::int64_t> stamps_ns,
                                                            const ChannelSamples& channel);

} // namespace dyncal::analysis
