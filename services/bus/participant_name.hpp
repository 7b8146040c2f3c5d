// What people are told of a participant: its name, process and host as its DDS library announces
// them. Whoever it is cannot choose another one by what a message says. Plain functions, any
// thread.
#pragma once

#include <array>
#include <string>

#include "services/bus/discovery.hpp"

namespace dyncal::bus {

// The properties that tell them, of Cyclone DDS and of Fast DDS.
inline constexpr std::array process_keys{"__Pid", "fastdds.physical_data.process"};
inline constexpr std::array host_keys{"__Hostname", "fastdds.physical_data.host"};

// "dyncal-acs:4711 on lab-2", as DiscoveredParticipant has it; without what is empty. Fast DDS puts
// a number behind the host, which is left out.
[[nodiscard]] std::string participant_name(const std::string& name, const std::string& process,
                                           const std::string& host);

// Of the participant with this id; "participant 0110..." where it is not known.
[[nodiscard]] std::string name_of(const Discovery& discovery, const std::string& id);

} // namespace dyncal::bus
