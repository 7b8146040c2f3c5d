// What the channels that one clock recorded do along a step, learnt from one more pass over their
// samples: noise with a memory (noise_near_signal.hpp), also for the frequency that the pilot gave
// them (frequency_noise.hpp), knocks (short_disturbance.hpp), and their phasors in blocks, for the
// ratio of channels (ratio_blocks.hpp).
//
// Changes the channels: their noise, their knock, and u of their frequency. Any thread.
#pragma once

#include <optional>
#include <vector>

#include "analysis/method/channels_of_one_clock.hpp"
#include "analysis/method/step_findings.hpp"
#include "analysis/uncertainty/ratio_blocks.hpp"

namespace dyncal::analysis {

// Empty where a channel is too short or too weak.
struct BlocksOfClock {
  std::optional<BlockSeries> pilot;
  std::vector<std::optional<BlockSeries>> others;

  // Of the other, its phase against the pilot's.
  [[nodiscard]] std::optional<BlockSeries> beside_pilot(std::size_t other) const;
};

[[nodiscard]] BlocksOfClock learn_from_blocks(ChannelsOfOneClock& system);
[[nodiscard]] std::optional<BlockSeries> learn_from_blocks(RecordedChannel& channel);
// Only u of the frequency.
void learn_frequency_noise(ChannelsOfOneClock& system);

// Empty where one of the two is.
[[nodiscard]] std::optional<RatioInBlocks> compare(const std::optional<BlockSeries>& numerator,
                                                   const std::optional<BlockSeries>& denominator,
                                                   const BlockAlignment& alignment);

// By how both signals began, where their records show it. `distance_s`: the first stamp of the
// numerator after that of the time scale that its blocks are on.
[[nodiscard]] std::optional<SeenOffset> seen_offset(const RecordedChannel& numerator,
                                                    const RecordedChannel& denominator,
                                                    double distance_s = 0.0);

// A row of kind `structure`: what the scatter of the ratio along the records shows beyond the
// expected uncertainties, and what is not known of its correction.
void add_ratio_rows(Budget& budget, const std::optional<RatioInBlocks>& ratio,
                    double expected_magnitude_rel, double expected_phase_rad);

// By how much the value changes, and what is to be said of it.
[[nodiscard]] std::complex<double> factor_of(const std::optional<RatioInBlocks>& ratio);
[[nodiscard]] PointFindings findings_of(const std::optional<RatioInBlocks>& ratio,
                                        bool too_short_for_noise);
void add_knock(const RecordedChannel& channel, StepFindings& findings);

} // namespace dyncal::analysis
