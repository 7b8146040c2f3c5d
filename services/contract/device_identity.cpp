#include "services/contract/device_identity.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/core.h>

#include "services/contract/quantity.hpp"
#include "services/contract/unit.hpp"

namespace dyncal::inline contract {
namespace {

// Nothing: its values are published as they are.
std::optional<ChannelUnit> conversion_of(const drivers::ChannelDescription& channel,
                                         const DeviceIdentity& identity) {
  if (const auto stated = identity.units.find(channel.name); stated != identity.units.end()) {
    return stated->second;
  }
  if (channel.unit.empty() || to_d_si(channel.unit)) {
    return std::nullopt;
  }
  const auto own = parse_channel_unit(channel.unit);
  return own && own->is_conversion() ? std::optional(*own) : std::nullopt;
}

void apply(const ChannelUnit& unit, drivers::ChannelDescription& channel) {
  const double factor = unit.factor_from(channel.unit);
  std::tie(channel.minimum, channel.maximum) =
      std::minmax({factor * channel.minimum, factor * channel.maximum});
  channel.resolution *= std::abs(factor);
  channel.unit = unit.d_si;
  channel.quantity += (channel.quantity.empty() ? "from " : ", from ") + unit.written;
}

} // namespace

drivers::SourceDescription with_identity(drivers::SourceDescription description,
                                         const DeviceIdentity& identity) {
  for (const auto& [stated, member] : {std::pair(&identity.device, &description.device),
                                       std::pair(&identity.serial, &description.serial),
                                       std::pair(&identity.firmware, &description.firmware)}) {
    if (!stated->empty()) {
      *member = *stated;
    }
  }
  for (drivers::ChannelDescription& channel : description.channels) {
    if (const auto unit = conversion_of(channel, identity)) {
      apply(*unit, channel);
    }
    if (const auto range = identity.ranges.find(channel.name); range != identity.ranges.end()) {
      channel.minimum = range->second.minimum;
      channel.maximum = range->second.maximum;
    }
  }
  return description;
}

std::vector<double> unit_factors(const drivers::SourceDescription& described,
                                 const DeviceIdentity& identity) {
  std::vector<double> factors;
  bool is_changed = false;
  for (const drivers::ChannelDescription& channel : described.channels) {
    const auto unit = conversion_of(channel, identity);
    factors.push_back(unit ? unit->factor_from(channel.unit) : 1.0);
    is_changed |= factors.back() != 1.0;
  }
  return is_changed ? factors : std::vector<double>();
}

void convert(const std::vector<double>& factors, std::size_t samples, std::vector<double>& values) {
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const std::size_t end = std::min((i + 1) * samples, values.size());
    for (std::size_t j = i * samples; j < end && factors[i] != 1.0; ++j) {
      values[j] *= factors[i];
    }
  }
}

std::vector<std::string> unit_doubts(const drivers::SourceDescription& described,
                                     const DeviceIdentity& identity) {
  std::vector<std::string> doubts;
  for (const drivers::ChannelDescription& channel : described.channels) {
    const auto stated = identity.units.find(channel.name);
    const bool says_nothing = channel.unit.empty() || channel.unit == R"(\one)";
    if (stated == identity.units.end() || says_nothing || channel.unit == stated->second.written ||
        (stated->second.from_v != 0.0 && quantity_of_unit(channel.unit) == Quantity::voltage)) {
      continue;
    }
    doubts.push_back(fmt::format("channel '{}' is taken to be in {}, as the bench file says; it "
                                 "is said by its source to be in {}",
                                 channel.name, stated->second.written, short_form(channel.unit)));
  }
  return doubts;
}

Expected<void> check_units(const drivers::SourceDescription& described,
                           const DeviceIdentity& identity) {
  for (const auto& [channel, unit] : identity.units) {
    if (std::ranges::find(described.channels, channel, &drivers::ChannelDescription::name) ==
        described.channels.end()) {
      return fail(
          ErrorCode::bad_argument,
          fmt::format("a unit is given for '{}', which is not one of its channels", channel));
    }
  }
  return {};
}

} // namespace dyncal::inline contract
