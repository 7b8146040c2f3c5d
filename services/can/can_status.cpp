#include "services/can/can_status.hpp"

#include <fmt/format.h>

namespace dyncal::services::can {

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

SourceCounts to_counts(const drivers::can::SensorStream& stream) {
  const drivers::can::SensorCounts counts = stream.counts();
  SourceCounts published;
  published.received = counts.samples;
  published.lost_on_way = counts.lost;
  published.duplicates = counts.repeated;
  published.rejected = counts.rejected + counts.incomplete;
  published.stamps_not_trusted = counts.not_trusted;
  published.clock_uncertainty_s = stream.u_stamp_s();
  const auto add = [&](const std::string& name, std::uint64_t value) {
    if (value > 0) {
      published.causes.emplace_back(name, value);
    }
  };
  add("frames received", counts.frames);
  add("frames dropped by the socket", counts.dropped_frames);
  add("samples of which a frame is missing", counts.incomplete);
  add("frames without counter, SYNC or known rate", counts.rejected);
  add("signals beyond the end of a frame", counts.short_frames);
  add("signals not available or in error", counts.no_value);
  add("interruptions of the link", counts.interruptions);
  add("restarts of the sensor", counts.restarts);
  add("restarts of a clock", counts.clock_restarts);
  for (const auto& [cause, number] : counts.faults) {
    add("bus: " + cause, number);
  }
  const drivers::can::LinkState& link = stream.link();
  add("controller restarts", link.restarts);
  add("transmit error counter", link.transmit_errors.value_or(0));
  add("receive error counter", link.receive_errors.value_or(0));
  return published;
}

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
  const drivers::can::SensorCounts counts = stream.counts();
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

} // namespace dyncal::services::can
