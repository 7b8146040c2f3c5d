// What Cyclone DDS logs: to standard error as by itself, but for malformed packets, which are
// counted. Left alone it writes up to a kilobyte about each, however many come. Of the rest as many
// as line_limit.hpp lets pass.
//
// Its log is one a process, so all participants of a process share the count.
#pragma once

#include <memory>

#include "services/bus/refused_packets.hpp"

namespace dyncal::bus {

// The first call's `warn` is told of the first packet.
[[nodiscard]] std::shared_ptr<RefusedPackets>
packets_refused_by_cyclone_dds(const std::function<void(const std::string&)>& warn);

} // namespace dyncal::bus
