// Participants of a secured laboratory: the files that DDS Security is given, whichever vendor
// carries the messages.
//
// A secured participant sends a message of up to 64 kB as one, cut by IP alone: both vendors
// together lose the first fragments that come before the keys do, and Fast DDS 2.9 then does not
// end looking for them. So blocks of samples are short there (decisions/25-secured-blocks.md).
//
// Threads as bus.hpp has them.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "services/bus/bus.hpp"

namespace dyncal::bus {

struct SecurityFiles {
  std::filesystem::path authority; // of certificates and of permissions
  std::filesystem::path certificate;
  std::filesystem::path private_key;
  std::filesystem::path governance;
  std::filesystem::path permissions;
  std::filesystem::path revoked;
};

// Whether nothing more is taken from this writer, which may be unknown. Called from any thread.
using IsRevoked = std::function<bool(const WriterId& writer)>;

struct SecuredParticipant {
  Participant participant;
  // As Participant::discovered(), wherever the participant is moved to; nobody once it is gone.
  std::function<Discovery()> discovered;
};

// Fails (network) as Participant::create() does, and when the vendor refuses the files; they are
// checked before by services/security, whose sentences are better.
[[nodiscard]] base::Expected<SecuredParticipant>
create_secured_participant(const ParticipantOptions& options, const SecurityFiles& files,
                           IsRevoked is_revoked);

// Whether the vendor's certificates need a subject whose SHA-256 begins with 1 instead of 0. The
// participant with the lower GUID, which follows from the subject, begins the handshake, and
// Cyclone DDS does not understand how Fast DDS begins it.
[[nodiscard]] bool needs_high_subject(Vendor vendor);

// Whether the vendor in this build finds no other vendor, and no other version of itself, once both
// are secured: Fast DDS 3 does not send them its keys.
[[nodiscard]] bool speaks_alone_when_secured(Vendor vendor);

// What the vendor lacks on this host to be secured, as a sentence; nothing if it has all.
[[nodiscard]] std::optional<std::string> what_security_lacks(Vendor vendor);

} // namespace dyncal::bus
