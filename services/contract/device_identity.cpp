#include "services/contract/device_identity.hpp"

#include <utility>

namespace dyncal::inline contract {

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
    if (const auto range = identity.ranges.find(channel.name); range != identity.ranges.end()) {
      channel.minimum = range->second.minimum;
      channel.maximum = range->second.maximum;
    }
  }
  return description;
}

} // namespace dyncal::inline contract
