// The adapters of the DDS vendors, as bus.cpp sees them. A build may lack either (DYNCAL_FAST_DDS,
// DYNCAL_CYCLONE_DDS).
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "services/bus/bus.hpp"

namespace dyncal::bus {

struct SecurityFiles;

// Of any vendor. Fails (network) as Participant::create() does. `security` may be null.
[[nodiscard]] base::Expected<std::unique_ptr<UntypedParticipant>>
create_untyped_participant(const ParticipantOptions& options, const SecurityFiles* security);

// Neither throws; the error names the option that cannot be used.
[[nodiscard]] base::Expected<std::unique_ptr<UntypedParticipant>>
create_fast_dds_participant(const ParticipantOptions& options, const SecurityFiles* security);
[[nodiscard]] base::Expected<std::unique_ptr<UntypedParticipant>>
create_cyclone_dds_participant(const ParticipantOptions& options, const SecurityFiles* security);

// As what_security_lacks() of participant_security.hpp.
[[nodiscard]] std::optional<std::string> what_cyclone_dds_security_lacks();

} // namespace dyncal::bus
