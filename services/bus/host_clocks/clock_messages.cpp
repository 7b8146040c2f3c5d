#include "services/bus/host_clocks/clock_messages.hpp"

#include <unistd.h>

#include "services/bus/host_network.hpp"
#include "services/bus/names.hpp"

namespace dyncal::inline host_clocks {

std::string service_name(const ProgramIdentity& identity) {
  const std::string name =
      identity.program + ":" + std::to_string(identity.process_id) + "@" + identity.host;
  return name.substr(0, bus::max_name);
}

ProgramIdentity this_program(const std::string& program, const std::string& software,
                             const std::string& dds) {
  return {.program = program,
          .host = bus::host_name(),
          .process_id = static_cast<std::uint32_t>(getpid()),
          .software = software,
          .dds = dds};
}

ProgramIdentity identity_of(const wire::ClockAnswer& answer) {
  return {.program = answer.program(),
          .host = answer.host(),
          .process_id = answer.process_id(),
          .software = answer.software(),
          .dds = answer.dds()};
}

} // namespace dyncal::inline host_clocks
