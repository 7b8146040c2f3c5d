#include "services/contract/source_description.hpp"

#include <array>
#include <utility>

#include <fmt/core.h>

#include "idl/dyncal.h"
#include "services/base/printable_text.hpp"
#include "services/contract/message_members.hpp"

namespace dyncal::inline contract {
namespace {

using drivers::StampInstant;
using drivers::TimeBase;

constexpr auto time_bases = std::to_array<std::pair<TimeBase, wire::TimeBase>>(
    {{TimeBase::local, wire::TIME_BASE_LOCAL}, {TimeBase::utc, wire::TIME_BASE_UTC}});

constexpr auto instants = std::to_array<std::pair<StampInstant, wire::StampInstant>>({
    {StampInstant::unknown, wire::STAMP_UNKNOWN},
    {StampInstant::data_ready_edge, wire::STAMP_DATA_READY_EDGE},
    {StampInstant::conversion, wire::STAMP_CONVERSION},
    {StampInstant::trigger_edge, wire::STAMP_TRIGGER_EDGE},
    {StampInstant::frame_start, wire::STAMP_FRAME_START},
    {StampInstant::frame_end, wire::STAMP_FRAME_END},
});

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

void message_members(auto& visit, Either<drivers::ChannelDescription> auto& channel,
                     auto& message) {
  visit(channel.name, message.name());
  visit(channel.quantity, message.quantity());
  visit(channel.unit, message.unit());
  visit(channel.minimum, message.minimum());
  visit(channel.maximum, message.maximum());
  visit(channel.resolution, message.resolution());
}

void message_members(auto& visit, Either<drivers::QuadratureSignals> auto& signals, auto& message) {
  visit(signals.channel, message.channel());
  visit(signals.displacement_per_turn_m, message.displacement_per_turn_m());
  visit(signals.u_wavelength_rel, message.u_wavelength_rel());
  visit(signals.centre_u1, message.centre_u1());
  visit(signals.centre_u2, message.centre_u2());
  visit(signals.radius_u1, message.radius_u1());
  visit(signals.radius_ratio, message.radius_ratio());
  visit(signals.quadrature_error_rad, message.quadrature_error_rad());
  visit(signals.turns_covered, message.turns_covered());
  visit(signals.ellipse_from, message.ellipse_from());
  visit(signals.u_ellipse_rad, message.u_ellipse_rad());
  visit(signals.periodic_error_rad, message.periodic_error_rad());
  visit(signals.detector_bandwidth_hz, message.detector_bandwidth_hz());
  visit(signals.u_skew_s, message.u_skew_s());
  visit(signals.radius_deviation_rel, message.radius_deviation_rel());
}

void message_members(auto& visit, Either<drivers::SourceDescription> auto& description,
                     auto& message) {
  visit(description.device, message.device());
  visit(description.serial, message.serial());
  visit(description.firmware, message.firmware());
  visit(description.driver, message.driver());
  visit(description.channels, message.channels());
  visit(description.nominal_rate_hz, message.nominal_rate_hz());
  visit.named(description.time_base, message.time_base(), time_bases);
  visit.named(description.stamp_instant, message.stamp_instant(), instants);
  visit(description.tick_s, message.tick_s());
  visit(description.stamp_uncertainty_s, message.stamp_uncertainty_s());
  visit(description.quadrature_signals, message.quadrature_signals());
}

wire::SourceDescription to_message(const drivers::SourceDescription& description) {
  wire::SourceDescription message;
  MessageWriter writer;
  message_members(writer, description, message);
  return message;
}

drivers::SourceDescription from_message(const wire::SourceDescription& message) {
  drivers::SourceDescription description;
  MessageReader reader;
  message_members(reader, description, message);
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
