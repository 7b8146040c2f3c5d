// A source that records the pulse-per-second output of a GPS receiver in one of its channels, and
// whose samples get UTC by it (analysis/clock/pulse_clock.hpp) in place of the instrument's clock.
//
// All channels stay as they are, that of the pulses too: what the stamps were made of is recorded.
// A pulse is `delay_s` late where it reaches the input. Uncertainty of stamps: of the line through
// the pulses, and of the delay.
//
// Before eight pulses nobody knows the time: samples until then are left out and counted
// ("before_pulses"). Without pulses time goes on by the last line, its uncertainty grows, and after
// a minute stamps are flagged as not trusted. Pulses that have moved are a new session. Each of
// these is warned of once.
//
// The description fails (invalid_setting) where there is no such channel. Threads as SampleSource.
#pragma once

#include <memory>
#include <utility>

#include "drivers/pps/pulse_settings.hpp"
#include "drivers/sample_source.hpp"

namespace dyncal::drivers::pps {

class PulseStampedSource : public SampleSource {
public:
  PulseStampedSource(std::unique_ptr<SampleSource> instrument, PulseSettings settings)
      : instrument_(std::move(instrument)), settings_(std::move(settings)) {}

  [[nodiscard]] Expected<SourceDescription> describe() override;
  [[nodiscard]] Expected<void> run(SampleSink& sink) override;
  void stop() override { instrument_->stop(); }

private:
  std::unique_ptr<SampleSource> instrument_;
  PulseSettings settings_;
};

} // namespace dyncal::drivers::pps
