#include "drivers/pps/pulse_stamped_source.hpp"

#include "drivers/pps/pulse_stamps.hpp"

namespace dyncal::drivers::pps {

Expected<SourceDescription> PulseStampedSource::describe() {
  DYNCAL_TRY(const auto description, instrument_->describe());
  return described_in_utc(description, settings_);
}

Expected<void> PulseStampedSource::run(SampleSink& sink) {
  PulseStamps stamps(settings_, sink);
  return instrument_->run(stamps);
}

} // namespace dyncal::drivers::pps
