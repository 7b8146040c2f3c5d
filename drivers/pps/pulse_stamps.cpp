#include "drivers/pps/pulse_stamps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyncal::drivers::pps {
namespace {

constexpr double warn_after_s = 10.0; // without pulses
constexpr double trusted_for_s = 60.0;

std::optional<std::size_t> column_of(const SourceDescription& description,
                                     const std::string& name) {
  const auto& channels = description.channels;
  const auto found = std::find_if(channels.begin(), channels.end(),
                                  [&](const auto& one) { return one.name == name; });
  return found == channels.end()
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - channels.begin()));
}

std::uint32_t in_ns(double seconds) {
  constexpr double most = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::clamp(std::ceil(seconds * 1e9), 1.0, most));
}

} // namespace

Expected<SourceDescription> described_in_utc(const SourceDescription& instrument,
                                             const PulseSettings& settings) {
  if (!column_of(instrument, settings.channel)) {
    return fail(ErrorCode::invalid_setting, "no channel '" + settings.channel +
                                                "' that records pulses; name the one that the "
                                                "pulse-per-second output is connected to");
  }
  if (instrument.nominal_rate_hz <= 0.0) {
    return fail(ErrorCode::invalid_setting,
                "its sample rate is not known, which is needed to find pulses in a channel");
  }
  SourceDescription description = instrument;
  description.time_base = TimeBase::utc;
  description.tick_s = 0.0;
  description.stamp_uncertainty_s = settings.u_delay_s;
  return description;
}

void PulseStamps::describe(const SourceDescription& description) {
  const auto column = column_of(description, settings_.channel);
  const auto in_utc = described_in_utc(description, settings_);
  is_described_ = in_utc.has_value();
  if (!is_described_) {
    sink_.warn(in_utc.error().message);
    return;
  }
  column_ = *column;
  description_ = *in_utc;
  if (!pulses_) {
    pulses_.emplace(description_.nominal_rate_hz, settings_.edge);
    clock_.emplace(description_.nominal_rate_hz);
  }
  sink_.describe(description_);
}

void PulseStamps::begin_session() {
  pulses_.reset();
  clock_.reset();
  next_sample_.reset();
  has_warned_ = false;
  sink_.begin_session();
}

void PulseStamps::take(SampleBlock block) {
  if (!is_described_ || block.samples == 0) {
    before_pulses_ += block.samples;
    return;
  }
  if (next_sample_ != block.first_sample) {
    pulses_->restart(block.first_sample);
  }
  next_sample_ = block.first_sample + block.samples;
  take_pulses(block);
  watch(block);
  if (!clock_->is_known()) {
    before_pulses_ += block.samples;
    return;
  }
  stamp(block);
  sink_.take(std::move(block));
}

void PulseStamps::take_pulses(const SampleBlock& block) {
  const std::span<const double> values(block.values);
  const std::uint64_t behind = block.first_sample + block.samples;
  for (const analysis::SampledPulse& pulse :
       pulses_->push(values.subspan(column_ * block.samples, block.samples))) {
    const double ago_s =
        (static_cast<double>(behind - pulse.sample) - pulse.part) / description_.nominal_rate_hz;
    switch (clock_->add(pulse, block.received_utc_ns - std::llround(ago_s * 1e9))) {
    case analysis::PulseClock::Answer::taken:
      break;
    case analysis::PulseClock::Answer::left_out:
      ++left_out_;
      break;
    case analysis::PulseClock::Answer::moved:
      sink_.warn("the pulses in channel '" + settings_.channel +
                 "' have moved against the samples: their time is learnt anew, in a new session");
      sink_.begin_session();
      sink_.describe(description_);
      break;
    }
  }
}

void PulseStamps::watch(const SampleBlock& block) {
  if (pulses_->restless() > 0 && !has_warned_of_restless_) {
    has_warned_of_restless_ = true;
    sink_.warn("the levels of the pulses in channel '" + settings_.channel +
               "' wander beside their edges, as those of an AC-coupled input do; couple it DC");
  }
  const bool is_without = clock_->is_known() &&
                          clock_->since_pulse_s(block.first_sample + block.samples) > warn_after_s;
  if (is_without && !has_warned_) {
    sink_.warn("no pulses in channel '" + settings_.channel +
               "' any more: the time goes on by the last ones, and is not trusted after a minute");
  }
  has_warned_ = is_without;
}

void PulseStamps::stamp(SampleBlock& block) {
  const std::int64_t delay_ns = std::llround(settings_.delay_s * 1e9);
  const std::uint64_t last = block.first_sample + block.samples - 1;
  const double u_s = std::max(clock_->u_s(block.first_sample), clock_->u_s(last));
  block.clock.reset();
  block.stamps_ns.resize(block.samples);
  for (std::size_t i = 0; i < block.samples; ++i) {
    block.stamps_ns[i] = clock_->utc_ns(block.first_sample + i) + delay_ns;
  }
  block.stamp_uncertainty_ns.assign(block.samples, in_ns(std::hypot(u_s, settings_.u_delay_s)));
  if (clock_->since_pulse_s(last) > trusted_for_s) {
    block.flags.assign(block.samples, stamp_no_uncertainty);
    not_trusted_ += block.samples;
  }
}

void PulseStamps::count(const SampleCounts& counts) {
  SampleCounts all = counts;
  all.stamps_not_trusted += not_trusted_;
  all.add_cause("before_pulses", before_pulses_);
  all.add_cause("pulses_left_out", left_out_);
  sink_.count(all);
}

} // namespace dyncal::drivers::pps
