#include "drivers/can/bus/frame_source.hpp"

namespace dyncal::drivers::can {

const char* to_string(BusState state) {
  switch (state) {
  case BusState::error_active:
    return "error active";
  case BusState::error_warning:
    return "error warning";
  case BusState::error_passive:
    return "error passive";
  case BusState::bus_off:
    return "bus-off";
  case BusState::stopped:
    return "stopped";
  case BusState::sleeping:
    return "sleeping";
  case BusState::unknown:
    break;
  }
  return "unknown";
}

} // namespace dyncal::drivers::can
