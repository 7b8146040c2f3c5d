#include "services/daemon/program/secured_network.hpp"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <ctime>
#include <memory>

#include <spdlog/spdlog.h>

#include "services/security/identity_check.hpp"
#include "services/security/identity_folder.hpp"
#include "services/security/revoked_participants.hpp"

namespace dyncal::inline daemon {

Expected<bus::ParticipantOptions> participant_options(const NetworkOptions& options,
                                                      const std::string& program,
                                                      const NetworkUse& use) {
  DYNCAL_TRY(const auto vendor, bus::parse_vendor(options.dds));
  bus::ParticipantOptions participant;
  participant.vendor = vendor;
  participant.laboratory =
      options.vendors == "same" ? bus::LaboratoryVendors::same : bus::LaboratoryVendors::mixed;
  participant.domain = options.domain;
  participant.name = program;
  participant.peers = options.peers;
  participant.multicast = !options.no_multicast;
  participant.interface_name = options.interface_name;
  participant.watch_discovery = use.watch_discovery;
  participant.warn = [](const std::string& sentence) { spdlog::warn("{}", sentence); };
  return participant;
}

Expected<bus::SecuredParticipant> join_secured_network(const NetworkOptions& options,
                                                       const std::string& program,
                                                       const NetworkUse& use) {
  DYNCAL_TRY(const auto participant, participant_options(options, program, use));
  DYNCAL_TRY(require_identity(options.security, participant.vendor, program, std::time(nullptr)));
  const auto files = security_files(options.security, participant.vendor);
  const auto revoked = std::make_shared<RevokedParticipants>(files, participant.warn,
                                                             [] { kill(getpid(), SIGTERM); });
  return bus::create_secured_participant(participant, files, [=](const bus::WriterId& writer) {
    return revoked->hold(writer, std::chrono::steady_clock::now());
  });
}

} // namespace dyncal::inline daemon
