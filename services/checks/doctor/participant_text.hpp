// A participant of a DDS domain as people find it: what it calls itself, its DDS implementation,
// and the address that its announcements come from. Plain function, any thread.
#pragma once

#include <string>

#include "services/checks/doctor/laboratory_view.hpp"

namespace dyncal::inline checks::doctor {

// By its id: "dyncal-acs:4711 on lab-2 (Cyclone DDS, 10.98.0.2)".
[[nodiscard]] std::string participant_text(const LaboratoryView& view, const std::string& id);

} // namespace dyncal::inline checks::doctor
