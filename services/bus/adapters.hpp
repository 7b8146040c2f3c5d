// The adapters of the DDS vendors, as bus.cpp sees them. A build may lack either (DYNCAL_FAST_DDS,
// DYNCAL_CYCLONE_DDS).
#pragma once

#include <memory>

#include "services/bus/bus.hpp"

namespace dyncal::bus {

// Neither throws; the error names the option that cannot be used.
[[nodiscard]] base::Expected<std::unique_ptr<UntypedParticipant>>
create_fast_dds_participant(const ParticipantOptions& options);
[[nodiscard]] base::Expected<std::unique_ptr<UntypedParticipant>>
create_cyclone_dds_participant(const ParticipantOptions& options);

} // namespace dyncal::bus
