#include "services/checks/doctor/participant_text.hpp"

#include <algorithm>

#include <fmt/core.h>

namespace dyncal::inline checks::doctor {

std::string participant_text(const LaboratoryView& view, const std::string& id) {
  const auto found =
      std::ranges::find(view.discovery.participants, id, &bus::DiscoveredParticipant::id);
  if (found == view.discovery.participants.end()) {
    return "participant " + id;
  }
  const auto address = view.addresses.find(id);
  const std::string from = address == view.addresses.end() ? "" : ", " + address->second;
  return fmt::format("{} ({}{})", found->name.empty() ? "a program" : found->name, found->vendor,
                     from);
}

} // namespace dyncal::inline checks::doctor
