// Which sound device is opened, and how. Plain data, any thread.
#pragma once

#include <string>

#include "drivers/alsa/sample_format.hpp"

namespace dyncal::drivers::alsa {

struct DeviceSettings {
  std::string device;   // as ALSA names it: "hw:CARD=Device,DEV=0"
  unsigned rate_hz = 0; // exactly this
  SampleFormat format = SampleFormat::s32;
  unsigned channels = 0; // exactly as many
};

} // namespace dyncal::drivers::alsa
