#include "services/evaluation/method/calibrated_channels.hpp"

namespace dyncal::inline evaluation {

std::vector<ChannelName> calibrated_channels(const Recipe& recipe, const SourceRecord& dau) {
  const RoleNames& roles = recipe.roles;
  if (!roles.dut.empty() || !dau.described()) {
    return roles.dut;
  }
  std::vector<ChannelName> names;
  for (const drivers::ChannelDescription& channel : dau.description().channels) {
    const ChannelName name{dau.source(), channel.name};
    const bool thermometer = channel.unit == R"(\degreecelsius)" || channel.unit == R"(\kelvin)";
    const bool analogue_input = channel.unit == R"(\volt)";
    if (name != roles.sync_sensor && name != roles.temperature && !thermometer && !analogue_input) {
      names.push_back(name);
    }
  }
  return names;
}

} // namespace dyncal::inline evaluation
