#include "services/contract/source_description.hpp"

#include <fmt/core.h>

#include "idl/dyncal.h"
#include "services/base/printable_text.hpp"

namespace dyncal::inline contract {
namespace {

drivers::StampInstant stamp_instant(wire::StampInstant instant) {
  switch (instant) {
  case wire::STAMP_DATA_READY_EDGE:
    return drivers::StampInstant::data_ready_edge;
  case wire::STAMP_CONVERSION:
    return drivers::StampInstant::conversion;
  case wire::STAMP_TRIGGER_EDGE:
    return drivers::StampInstant::trigger_edge;
  case wire::STAMP_FRAME_START:
    return drivers::StampInstant::frame_start;
  case wire::STAMP_FRAME_END:
    return drivers::StampInstant::frame_end;
  default:
    return drivers::StampInstant::unknown;
  }
}

bool differs(const std::string& first, const std::string& now) {
  return !first.empty() && !now.empty() && first != now;
}

std::string device_text(const drivers::SourceDescription& description) {
  const std::string device = description.device.empty() ? "a device" : description.device;
  return printable(description.serial.empty()
                       ? device
                       : fmt::format("{}, serial number {}", device, description.serial));
}

} // namespace

drivers::SourceDescription from_message(const wire::SourceDescription& message) {
  drivers::SourceDescription description;
  description.device = message.device();
  description.serial = message.serial();
  description.firmware = message.firmware();
  description.driver = message.driver();
  for (const wire::ChannelDescription& channel : message.channels()) {
    description.channels.push_back({channel.name(), channel.quantity(), channel.unit(),
                                    channel.minimum(), channel.maximum(), channel.resolution()});
  }
  description.nominal_rate_hz = message.nominal_rate_hz();
  description.time_base = message.time_base() == wire::TIME_BASE_UTC ? drivers::TimeBase::utc
                                                                     : drivers::TimeBase::local;
  description.stamp_instant = stamp_instant(message.stamp_instant());
  description.tick_s = message.tick_s();
  description.stamp_uncertainty_s = message.stamp_uncertainty_s();
  return description;
}

std::string device_difference(const std::string& source, const drivers::SourceDescription& first,
                              const drivers::SourceDescription& now) {
  if (!differs(first.device, now.device) && !differs(first.serial, now.serial)) {
    return "";
  }
  return fmt::format("source '{}' is another instrument than the run began with: now {}, then {}; "
                     "put that one back, or begin a new run",
                     source, device_text(now), device_text(first));
}

} // namespace dyncal::inline contract
