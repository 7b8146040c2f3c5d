#include "services/programs/can/can_status.hpp"

#include <fmt/core.h>

namespace dyncal::inline programs::can {

using drivers::can::BusState;

namespace {

constexpr auto max_silence = std::chrono::seconds(2);

std::string ids_of(const drivers::can::SensorStream& stream) {
  std::string ids;
  for (const drivers::can::FrameFilter& filter : stream.filters()) {
    ids += fmt::format("{}0x{:x}", ids.empty() ? "" : ", ", filter.id);
  }
  return ids;
}

} // namespace

std::string to_message(const drivers::can::SensorStream& stream,
                       std::chrono::nanoseconds listened) {
  const drivers::can::LinkState& link = stream.link();
  if (!link.present) {
    return fmt::format("interface '{}' is not there; waiting for it", link.name);
  }
  if (!link.up) {
    return fmt::format("interface '{0}' is down; 'ip link set {0} up' sets it up", link.name);
  }
  if (link.bus == BusState::bus_off) {
    return fmt::format("interface '{0}' is bus-off: check bit rate, wiring and termination; 'ip "
                       "link set {0} type can restart'",
                       link.name);
  }
  if (!link.carrier) {
    return fmt::format("interface '{}' has no bus", link.name);
  }
  if (link.bus == BusState::error_warning || link.bus == BusState::error_passive) {
    return fmt::format("interface '{}' is {}: check bit rate, wiring and termination", link.name,
                       to_string(link.bus));
  }
  const drivers::can::StreamCounts counts = stream.counts();
  if (counts.frames == 0 && listened > max_silence) {
    return fmt::format("interface '{}' is up, but none of the sensor's messages has come ({}); "
                       "check the ids of the DBC file, 'messages', "
                       "the bit rate and whether the sensor sends",
                       link.name, ids_of(stream));
  }
  if (counts.short_frames > 0) {
    return fmt::format("frames of the sensor are shorter than the DBC file says: {} signals lie "
                       "beyond their end and have no value",
                       counts.short_frames);
  }
  if (stream.u_stamp_s() > 1.0) {
    return "the system clock is not synchronised: stamps have no known relation to UTC (chrony, "
           "ptp4l, or 'u_utc_s')";
  }
  return "";
}

} // namespace dyncal::inline programs::can
