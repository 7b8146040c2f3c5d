// Why no analysis service is heard, as far as this host can tell: its own addresses, and what comes
// from others instead. It tells apart a host without an IPv4 address, a link that goes down and
// comes back, packets that get through one way only, a link that loses most of what is sent, a
// network without multicast, and a laboratory without an analysis. Plain function, any thread.
#pragma once

#include <string>

#include "services/doctor/host_view.hpp"
#include "services/doctor/laboratory_view.hpp"

namespace dyncal::services::doctor {

// It answers, or has spoken of a bench.
[[nodiscard]] bool analysis_is_heard(const LaboratoryView& view);

// A part of a sentence, such as "nothing is heard in DDS domain 7, ...; this host is 10.98.0.3
// (lab)".
[[nodiscard]] std::string why_no_analysis_is_heard(const LaboratoryView& view,
                                                   const HostView& host);

} // namespace dyncal::services::doctor
