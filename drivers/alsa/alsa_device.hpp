// A capture device of ALSA: a sound card's, or one that its configuration makes of others.
//
// Rate, format and channels are set as they are wanted or refused: nothing is resampled. read()
// waits for a period, some 50 ms, and ends at once when the stop signal is raised. One thread.
#pragma once

#include <memory>
#include <string>

#include "drivers/alsa/capture_device.hpp"
#include "drivers/alsa/device_settings.hpp"
#include "drivers/link/stop_signal.hpp"

namespace dyncal::drivers::alsa {

// `stop` has to outlive the device.
[[nodiscard]] std::unique_ptr<CaptureDevice> make_alsa_device(DeviceSettings settings,
                                                              const StopSignal& stop);

} // namespace dyncal::drivers::alsa
