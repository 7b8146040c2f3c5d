// One shot of the bench: the oscilloscope's single acquisition and the series that its trigger output started.
//
// Before the oscilloscope is armed, series that were left over are dropped; after it has triggered, the sensor's series is waited for. The
// sensor counts its triggers: unless exactly one more has been taken than at the shot before, the two records do not belong together, and
// the shot fails (a spurious or missed trigger). A shot that fails changes nothing; the next call tries again, over new connections where
// these were lost. One thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "drivers/dso/oscilloscope.hpp"
#include "drivers/tss/series_source.hpp"
#include "services/bench/bench_file.hpp"
#include "services/error.hpp"

namespace dyncal::services::dso {

struct ShotPair {
  drivers::dso::Shot trace;
  drivers::tss::Series series;
};

class ShotDevice {
public:
  // `oscilloscope` and `sensor` are sources of the bench file with these drivers. `stop` outlives the device.
  ShotDevice(const SourceSettings& oscilloscope, const SourceSettings& sensor, const drivers::StopSignal& stop);

  // Connects both, so that they can be described. The sensor's channels are known only with its first series.
  [[nodiscard]] Expected<void> connect(double frequency_hz);
  [[nodiscard]] Expected<ShotPair> take(double frequency_hz);

  [[nodiscard]] const std::string& oscilloscope_identity() const { return oscilloscope_.identity(); }

private:
  drivers::dso::Oscilloscope oscilloscope_;
  std::unique_ptr<drivers::tss::SeriesSource> sensor_;
  std::optional<std::uint64_t> last_trigger_; // the sensor's count at the last shot
};

// The trace of sync that a shot needs: some periods, the trigger in the middle.
[[nodiscard]] drivers::dso::Acquisition acquisition_for(double frequency_hz);

} // namespace dyncal::services::dso
