// Between an instrument and the sink of its samples: finds the pulses in them and gives them UTC
// (pulse_stamped_source.hpp). Called on the instrument's thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "analysis/clock/pulse_clock.hpp"
#include "analysis/clock/sampled_pulses.hpp"
#include "drivers/error.hpp"
#include "drivers/pps/pulse_settings.hpp"
#include "drivers/sample_sink.hpp"

namespace dyncal::drivers::pps {

// The instrument's description as it is with UTC. Fails (invalid_setting) where it has no channel
// of pulses, or no rate.
[[nodiscard]] Expected<SourceDescription> described_in_utc(const SourceDescription& instrument,
                                                           const PulseSettings& settings);

class PulseStamps : public SampleSink {
public:
  PulseStamps(const PulseSettings& settings, SampleSink& sink) : settings_(settings), sink_(sink) {}

  void describe(const SourceDescription& description) override;
  void begin_session() override;
  void take(SampleBlock block) override;
  void count(const SampleCounts& counts) override;
  void warn(const std::string& sentence) override { sink_.warn(sentence); }

private:
  void take_pulses(const SampleBlock& block);
  void stamp(SampleBlock& block);
  void watch(const SampleBlock& block);

  const PulseSettings& settings_;
  SampleSink& sink_;
  SourceDescription description_; // as the sink has it
  std::size_t column_ = 0;
  bool is_described_ = false;
  std::optional<analysis::SampledPulses> pulses_;
  std::optional<analysis::PulseClock> clock_;
  std::optional<std::uint64_t> next_sample_;
  std::uint64_t before_pulses_ = 0, left_out_ = 0, not_trusted_ = 0;
  bool has_warned_ = false, has_warned_of_restless_ = false;
};

} // namespace dyncal::drivers::pps
