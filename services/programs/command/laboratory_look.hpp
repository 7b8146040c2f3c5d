// A look of some seconds at the laboratory and at this host, for doctor's judges. It takes up to
// 10 s longer where a secured program has yet to authenticate another. Blocks.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "services/base/finding.hpp"
#include "services/checks/doctor/host_view.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "services/daemon/program/program.hpp"

namespace dyncal::inline programs {

struct LaboratoryLook {
  doctor::LaboratoryView view;
  doctor::HostView host;
  Findings about_multicast; // that could not be listened for
};

// Hands the look over before it leaves the bus: Cyclone DDS waits at its end for a packet that it
// sends to itself, and a firewall that is looked for may drop just that. Fails (network).
[[nodiscard]] Expected<void>
look_at_laboratory(const NetworkOptions& network, double seconds, const std::stop_token& stop,
                   const std::function<void(const LaboratoryLook&)>& judge);

} // namespace dyncal::inline programs
