// What a participant in Cyclone DDS has discovered: its built-in topics, read when asked. Any
// thread.
#pragma once

#include <dds/dds.h>

#include "services/bus/discovery.hpp"

namespace dyncal::bus {

// Everything in its domain but itself and its own writers and readers.
[[nodiscard]] Discovery discovered_by_cyclone_dds(dds_entity_t participant);

} // namespace dyncal::bus
