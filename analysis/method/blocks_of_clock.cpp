#include "analysis/method/blocks_of_clock.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/base/statistics.hpp"
#include "analysis/step/short_disturbance.hpp"
#include "analysis/uncertainty/coverage.hpp"
#include "analysis/uncertainty/frequency_noise.hpp"
#include "analysis/uncertainty/noise_near_signal.hpp"

namespace dyncal::analysis {
namespace {

// Residuals that a converter's steps make have no noise whose density could be estimated.
constexpr double hides_steps = 0.6; // residual over one step
// Fewer tell nothing of noise that is not white.
constexpr double known_noise_freedom = 6.0;
// Below, a drift that was taken out took noise beside the frequency with it.
constexpr double known_slope_periods = 4.0;

FittedValues fitted(const RecordedChannel& channel) {
  return {channel.values(), channel.fit_of_values()};
}

double periods_of(const RecordedChannel& channel) {
  return channel.result.frequency.hz() * 1e-9 *
         static_cast<double>(channel.stamps_ns.back() - channel.stamps_ns.front());
}

bool shows_noise(const RecordedChannel& channel) {
  return !channel.motion_stamps_ns.empty() ||
         channel.result.fit.residual_sd() > hides_steps * channel.samples.resolution;
}

NoiseNearSignal noise_of(const RecordedChannel& channel, std::span<const PhasorBlock> blocks) {
  const ChannelFit& result = channel.result;
  return periods_of(channel) < few_periods
             ? noise_of_few_periods(result.frequency, result.phase_origin_ns, channel.stamps(),
                                    channel.values(), channel.fit_of_values())
             : noise_from_blocks(blocks, result.fit);
}

void learn_noise(RecordedChannel& channel, std::span<const PhasorBlock> blocks) {
  if (!shows_noise(channel)) {
    return;
  }
  if (const NoiseNearSignal noise = noise_of(channel, blocks); !noise.white) {
    channel.noise_factor = noise.factor;
    channel.noise_degrees_of_freedom = noise.degrees_of_freedom;
    const bool few = noise.degrees_of_freedom < known_noise_freedom;
    const bool bent = periods_of(channel) < known_slope_periods && channel.drift_order > 0;
    channel.noise_unknown = noise.factor > 1.0 && (few || bent);
  }
}

// By how much u of the frequency is larger than white noise makes it.
double frequency_factor(const RecordedChannel& pilot, std::span<const PhasorBlock> blocks) {
  if (!(pilot.result.u_frequency_hz > 0.0) || !shows_noise(pilot)) {
    return 1.0;
  }
  const NoiseNearSignal noise = noise_of(pilot, blocks);
  if (periods_of(pilot) < few_periods) {
    return noise.white ? 1.0 : 0.5 * coverage_factor(noise.degrees_of_freedom) * noise.factor;
  }
  const double sd = noise.factor * pilot.result.fit.residual_sd();
  return noise.factor * factor_of_frequency_noise(blocks, pilot.result.fit, sd * sd);
}

void widen_frequency(ChannelsOfOneClock& system, std::span<const PhasorBlock> blocks) {
  const double factor = frequency_factor(system.pilot, blocks);
  system.pilot.result.u_frequency_hz *= factor;
  for (RecordedChannel& other : system.others) {
    other.result.u_frequency_hz *= factor;
  }
}

// Whether a closer look may find a knock: a block with more than its share of the residuals. Where
// blocks are few or none, always.
bool may_be_disturbed(std::span<const PhasorBlock> blocks) {
  constexpr std::size_t enough = 16;
  constexpr double share = 1.5; // of the usual variance; noise alone shows 8 standard deviations
  if (blocks.size() < enough) {
    return true;
  }
  std::vector<double> variances;
  double samples = 0.0;
  for (const PhasorBlock& block : blocks) {
    variances.push_back(block.rss / std::max(1.0, block.samples - 3.0));
    samples += block.samples / static_cast<double>(blocks.size());
  }
  const double largest = *std::max_element(variances.begin(), variances.end());
  return largest > (share + 8.0 * std::sqrt(2.0 / samples)) * upper_median(variances);
}

void find_knock(RecordedChannel& channel, std::span<const PhasorBlock> blocks) {
  if (may_be_disturbed(blocks)) {
    const bool moves = !channel.motion_stamps_ns.empty();
    channel.knock = find_short_disturbance(channel.result.frequency, channel.stamps(),
                                           moves ? channel.values() : channel.samples.values);
  }
}

// Of a channel that has stamps of its own, on the axis of the others.
std::vector<PhasorBlock> blocks_of(const RecordedChannel& channel) {
  const FittedValues values[] = {fitted(channel)};
  auto blocks = phasors_in_blocks(channel.result.frequency, channel.result.phase_origin_ns,
                                  channel.stamps(), values);
  const double later_s =
      static_cast<double>(channel.stamps().front() - channel.stamps_ns.front()) * 1e-9;
  for (PhasorBlock& block : blocks.front()) {
    block.centre_s += later_s;
  }
  return std::move(blocks.front());
}

// The pilot's first. In one pass, but for the channels that have stamps of their own.
std::vector<std::vector<PhasorBlock>> blocks_of(const ChannelsOfOneClock& system) {
  std::vector<const RecordedChannel*> channels{&system.pilot};
  for (const RecordedChannel& other : system.others) {
    channels.push_back(&other);
  }
  std::vector<FittedValues> together;
  for (const RecordedChannel* channel : channels) {
    if (channel->motion_stamps_ns.empty()) {
      together.push_back(fitted(*channel));
    }
  }
  const ChannelFit& pilot = system.pilot.result;
  std::vector<std::vector<PhasorBlock>> blocks;
  if (!together.empty()) {
    blocks =
        phasors_in_blocks(pilot.frequency, pilot.phase_origin_ns, system.pilot.stamps_ns, together);
  }
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (!channels[i]->motion_stamps_ns.empty()) {
      blocks.insert(blocks.begin() + static_cast<std::ptrdiff_t>(i), blocks_of(*channels[i]));
    }
  }
  return blocks;
}

std::optional<BlockSeries> learn(RecordedChannel& channel, std::span<const PhasorBlock> blocks) {
  learn_noise(channel, blocks);
  find_knock(channel, blocks);
  return block_series(blocks, channel.result.fit);
}

} // namespace

std::optional<BlockSeries> BlocksOfClock::beside_pilot(std::size_t other) const {
  std::optional<BlockSeries> series = others[other];
  if (series && pilot) {
    refer_phase(*series, *pilot, 0.0);
  }
  return pilot ? series : std::nullopt;
}

BlocksOfClock learn_from_blocks(ChannelsOfOneClock& system) {
  const std::vector<std::vector<PhasorBlock>> blocks = blocks_of(system);
  widen_frequency(system, blocks.front());
  BlocksOfClock result{learn(system.pilot, blocks.front()), {}};
  for (std::size_t i = 0; i < system.others.size(); ++i) {
    result.others.push_back(learn(system.others[i], blocks[i + 1]));
  }
  return result;
}

void learn_frequency_noise(ChannelsOfOneClock& system) {
  widen_frequency(system, blocks_of(system.pilot));
}

std::optional<BlockSeries> learn_from_blocks(RecordedChannel& channel) {
  return learn(channel, blocks_of(channel));
}

std::optional<RatioInBlocks> compare(const std::optional<BlockSeries>& numerator,
                                     const std::optional<BlockSeries>& denominator,
                                     const BlockAlignment& alignment) {
  return numerator && denominator ? compare_in_blocks(*numerator, *denominator, alignment)
                                  : std::nullopt;
}

std::optional<SeenOffset> seen_offset(const RecordedChannel& numerator,
                                      const RecordedChannel& denominator, double distance_s) {
  const auto onset_of = [](const RecordedChannel& channel) {
    const ChannelFit& result = channel.result;
    return sine_onset(result.frequency, result.phase_origin_ns, result.fit, channel.samples.rise,
                      channel.stamps_ns.front());
  };
  const auto a = onset_of(numerator), b = onset_of(denominator);
  return a && b ? std::optional(SeenOffset{a->before_s - b->before_s - distance_s,
                                           std::hypot(a->u_s, b->u_s)})
                : std::nullopt;
}

void add_ratio_rows(Budget& budget, const std::optional<RatioInBlocks>& ratio,
                    double expected_magnitude_rel, double expected_phase_rad) {
  if (!ratio) {
    return;
  }
  const auto beyond = [](double u, double expected) {
    return std::sqrt(std::max(0.0, u * u - expected * expected));
  };
  budget.add({.kind = ContributionKind::structure,
              .subject = "the ratio of the signals",
              .u_magnitude_rel = beyond(ratio->u_magnitude_rel, expected_magnitude_rel),
              .u_phase_rad = beyond(ratio->u_phase_rad, expected_phase_rad)});
  budget.add({.kind = ContributionKind::structure,
              .subject = "the exciter, where the clocks see other parts of it",
              .u_magnitude_rel = ratio->u_correction_magnitude_rel,
              .u_phase_rad = ratio->u_correction_phase_rad});
}

std::complex<double> factor_of(const std::optional<RatioInBlocks>& ratio) {
  return ratio ? std::exp(ratio->correction) : std::complex<double>(1.0, 0.0);
}

PointFindings findings_of(const std::optional<RatioInBlocks>& ratio, bool too_short_for_noise) {
  return {ratio ? ratio->change : std::nullopt, too_short_for_noise};
}

void add_knock(const RecordedChannel& channel, StepFindings& findings) {
  if (channel.knock) {
    findings.knocks.push_back({channel.result.channel, *channel.knock});
  }
}

} // namespace dyncal::analysis
