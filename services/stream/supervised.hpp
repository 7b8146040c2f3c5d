// The options of a SourceService that reports to the supervisor of its program.
#pragma once

#include <string>

#include "services/bus/bus.hpp"
#include "services/daemon/supervision/supervisor.hpp"
#include "services/stream/source_service.hpp"

namespace dyncal::inline stream {

// Both outlive the service. `is_secured`: the participant is.
[[nodiscard]] inline SourceServiceOptions
supervised(Supervisor& supervisor, const bus::Participant& participant, bool is_secured) {
  SourceServiceOptions options;
  options.max_block_bytes = is_secured ? max_secured_block_bytes : max_block_bytes;
  options.software = supervisor.identity().software;
  options.turned = [&supervisor, &participant, refused = participant.refused_packets()] {
    supervisor.report_refused_packets(refused->count());
    supervisor.report_malformed_messages(participant.malformed_messages());
    supervisor.turned();
  };
  options.reported = [&supervisor](const wire::SourceStatus& status, std::uint64_t written) {
    supervisor.report(status, written);
  };
  return options;
}

} // namespace dyncal::inline stream
