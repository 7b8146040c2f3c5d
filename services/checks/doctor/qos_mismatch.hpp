// By which QoS a writer and a reader do not match, as the DDS specification has it (1.4, 2.2.3, and
// DDS-XTypes 1.3, 7.6.3.1): what the reader asks for the writer has to offer. Partitions are left
// to check_endpoints.cpp. An implementation may be less strict: Fast DDS 2.9 looks at no latency
// budget, presentation or destination order. Plain function, any thread.
#pragma once

#include <string>
#include <vector>

#include "services/bus/discovery.hpp"

namespace dyncal::inline checks::doctor {

// Each policy with both values: "reliability: the reader asks for RELIABLE, the writer offers
// BEST_EFFORT". Empty: they match.
[[nodiscard]] std::vector<std::string> qos_mismatches(const bus::DiscoveredEndpoint& writer,
                                                      const bus::DiscoveredEndpoint& reader);

} // namespace dyncal::inline checks::doctor
