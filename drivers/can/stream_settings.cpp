#include "drivers/can/stream_settings.hpp"

namespace dyncal::drivers::can {

const char* to_string(TimeSource source) {
  switch (source) {
  case TimeSource::canopen_sync:
    return "canopen-sync";
  case TimeSource::payload_time:
    return "payload-time";
  case TimeSource::counter:
    return "counter";
  case TimeSource::hardware_stamp:
    return "hardware-stamp";
  case TimeSource::kernel_stamp:
    break;
  }
  return "kernel-stamp";
}

} // namespace dyncal::drivers::can
