// Why no analysis service is heard, as far as this host can tell: its own addresses, and what comes
// from others instead. It tells apart a host without an IPv4 address, a link that goes down and
// comes back, an overloaded link (its queue here is full; probes, or trial connections to hosts
// that announce programs, are lost or late), packets that get through one way only, a firewall, a
// network without multicast, and a laboratory without an analysis. Plain functions, any thread.
#pragma once

#include <set>
#include <string>

#include "services/checks/doctor/host_view.hpp"
#include "services/checks/doctor/laboratory_view.hpp"

namespace dyncal::inline checks::doctor {

// It answers, or has spoken of a bench.
[[nodiscard]] bool analysis_is_heard(const LaboratoryView& view);

// Addresses of other hosts that announce programs.
[[nodiscard]] std::set<std::string> announcing_hosts(const LaboratoryView& view,
                                                     const HostView& host);

// A part of a sentence, such as "nothing is heard in DDS domain 7, ...; this host is 10.98.0.3
// (lab)".
[[nodiscard]] std::string why_no_analysis_is_heard(const LaboratoryView& view,
                                                   const HostView& host);

} // namespace dyncal::inline checks::doctor
