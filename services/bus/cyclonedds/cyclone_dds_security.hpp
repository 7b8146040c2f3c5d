// What a participant in Cyclone DDS is told of DDS Security: its files, and the plug-ins, which lie
// in a folder beside the library and are found by their whole paths alone.
#pragma once

#include <dds/dds.h>

#include "services/bus/participant_security.hpp"

namespace dyncal::bus {

void set_cyclone_dds_security(const SecurityFiles& files, dds_qos_t& qos);

} // namespace dyncal::bus
