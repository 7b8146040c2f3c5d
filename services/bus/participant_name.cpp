#include "services/bus/participant_name.hpp"

#include <algorithm>

#include "services/base/printable_text.hpp"

namespace dyncal::bus {

std::string participant_name(const std::string& name, const std::string& process,
                             const std::string& host) {
  return base::one_line(name + (process.empty() ? "" : ":" + process) +
                        (host.empty() ? "" : " on " + host.substr(0, host.find(':'))));
}

std::string name_of(const Discovery& discovery, const std::string& id) {
  const auto known = std::ranges::find(discovery.participants, id, &DiscoveredParticipant::id);
  if (known == discovery.participants.end()) {
    return "participant " + id;
  }
  return known->name.empty() ? "a program with " + known->vendor : known->name;
}

} // namespace dyncal::bus
