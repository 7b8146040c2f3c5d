// One shot of the bench: the oscilloscope's single acquisition and the series that its trigger
// output started.
//
// Before the oscilloscope is armed, series that were left over are dropped; after it has triggered,
// the sensor's series is waited for. The sensor counts its triggers: a series that is late is
// dropped, and where the count leaves open whether the two records belong together (a spurious or
// missed trigger, trigger_count.hpp), the shot fails. A shot that fails changes nothing; the next
// call tries again, over new connections where these were lost. The first shot is no pair: whether
// its records belong together cannot be told, so it only tells the sensor's count. One thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "drivers/dso/oscilloscope.hpp"
#include "drivers/link/stop_signal.hpp"
#include "drivers/tss/series_source.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/instruments/trigger_count.hpp"

namespace dyncal::inline instruments {

struct ShotPair {
  drivers::dso::Shot trace;
  drivers::tss::Series series;
};

class ShotDevice {
public:
  // `stop` outlives the device.
  ShotDevice(const OscilloscopeSourceSettings& oscilloscope, const SeriesSourceSettings& sensor,
             const drivers::StopSignal& stop);

  // Connects both, so that they can be described. The sensor's channels are known only with its
  // first series.
  [[nodiscard]] Expected<void> connect(double frequency_hz);
  // Nothing: the shot only told the sensor's count; the next one can be taken at once.
  [[nodiscard]] Expected<std::optional<ShotPair>> take(double frequency_hz);

  [[nodiscard]] const std::string& oscilloscope_identity() const {
    return oscilloscope_.identity();
  }

private:
  [[nodiscard]] Expected<std::optional<drivers::tss::Series>> series_of_last_trigger();

  drivers::dso::Oscilloscope oscilloscope_;
  std::unique_ptr<drivers::tss::SeriesSource> sensor_;
  TriggerCount triggers_;
};

// The trace of sync that a shot needs: some periods, the trigger in the middle.
[[nodiscard]] drivers::dso::Acquisition acquisition_for(double frequency_hz);

} // namespace dyncal::inline instruments
