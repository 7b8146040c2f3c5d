// How a program joins a secured laboratory (--security), for programs that watch it; others join by
// program.hpp. Any thread.
#pragma once

#include <string>

#include "services/bus/participant_security.hpp"
#include "services/daemon/program/program.hpp"

namespace dyncal::inline daemon {

// What the network is asked for. Warnings go to the log. Fails (bad_argument) on any other --dds.
[[nodiscard]] Expected<bus::ParticipantOptions> participant_options(const NetworkOptions& options,
                                                                    const std::string& program,
                                                                    const NetworkUse& use);

// Fails as join_network(). REQUIRES: there is a folder of --security.
[[nodiscard]] Expected<bus::SecuredParticipant> join_secured_network(const NetworkOptions& options,
                                                                     const std::string& program,
                                                                     const NetworkUse& use);

} // namespace dyncal::inline daemon
