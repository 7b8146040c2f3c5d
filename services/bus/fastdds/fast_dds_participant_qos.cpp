#include "services/bus/fastdds/fast_dds_participant_qos.hpp"

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/log/StdoutErrConsumer.hpp>

#include "services/bus/fastdds/fast_dds_names.hpp"
#ifdef DYNCAL_FAST_DDS_3
#include <fastdds/LibrarySettings.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
#else
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#endif
#include "services/bus/fastdds/screened_transport.hpp"
#include "services/bus/host_network.hpp"
#include "services/bus/line_limit.hpp"
#include "services/bus/packet_size.hpp"
#include "services/bus/qos_profiles.hpp"

namespace dyncal::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = fast_dds::rtps;

constexpr const char* discovery_group = "239.255.0.1"; // DDSI-RTPS 9.6.1.4.1
constexpr std::uint32_t discovery_port(int domain) {
  return 7400U + 250U * static_cast<std::uint32_t>(domain);
}
constexpr std::uint32_t locators_per_participant =
    16; // hosts with containers easily have more than the default of 4

bool is_loopback(const std::string& address) {
  return address.starts_with("127.");
}

rtps::Locator_t locator(const std::string& address, std::uint32_t port) {
  rtps::Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  rtps::IPLocator::setIPv4(locator, address);
  locator.port = port;
  return locator;
}

// As many as pass: Fast DDS 2.9 has been seen to write 1.4 million lines in 15 s.
class LimitedConsumer : public dds::StdoutErrConsumer {
public:
  void Consume(const dds::Log::Entry& entry) override {
    if (limit_.passes(entry.message, std::chrono::steady_clock::now())) {
      dds::StdoutErrConsumer::Consume(entry);
    }
  }

private:
  LineLimit limit_;
};

// Its messages belong on standard error, like everybody's; by default they go to standard output.
void log_to_standard_error() {
  static const bool done = [] {
    auto consumer = std::make_unique<LimitedConsumer>();
    consumer->stderr_threshold(dds::Log::Kind::Info);
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::move(consumer));
    return true;
  }();
  static_cast<void>(done);
}

// Inside one process Fast DDS hands samples over directly by default, and a reader that has no room
// then never gets them.
void deliver_through_sockets_only() {
#ifdef DYNCAL_FAST_DDS_3
  eprosima::fastdds::LibrarySettings settings;
  settings.intraprocess_delivery = eprosima::fastdds::INTRAPROCESS_OFF;
  dds::DomainParticipantFactory::get_instance()->set_library_settings(settings);
#else
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
#endif
}

void set_transport(const std::string& address, int message_bytes, int send_buffer_bytes,
                   const std::shared_ptr<TransportState>& state, dds::DomainParticipantQos& qos) {
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->sendBufferSize = static_cast<std::uint32_t>(send_buffer_bytes);
  udp->receiveBufferSize = wanted_receive_buffer_bytes;
  // Of what is sent. A screened transport receives longer ones, too; without the screen it also
  // caps what can be received, and Cyclone DDS repairs with packets of up to 1456 bytes.
  udp->maxMessageSize = static_cast<std::uint32_t>(message_bytes);
  udp->maxInitialPeersRange = participants_per_host;
  // With the loopback interface in this list Fast DDS sends nothing at all; the locators keep to
  // it.
  if (!address.empty() && !is_loopback(address)) {
    udp->interfaceWhiteList.push_back(address);
  }
  qos.transport().use_builtin_transports =
      false; // no shared memory: it throttles blocks and leaves files behind
  if (state) {
    qos.transport().user_transports.push_back(screened(udp, state));
  } else {
    qos.transport().user_transports.push_back(udp);
  }
}

// Where it listens. Left alone, Fast DDS listens on every interface, multicast included, and
// announces all but the loopback one.
void set_locators(int domain, bool multicast, const std::string& address,
                  dds::DomainParticipantQos& qos) {
  if (multicast && address.empty()) {
    return;
  }
  auto& wire = qos.wire_protocol();
  const rtps::Locator_t own = address.empty()
                                  ? rtps::Locator_t()
                                  : locator(address, 0); // empty: all; port 0: the usual one
  wire.builtin.metatrafficUnicastLocatorList.push_back(own);
  if (multicast) {
    wire.builtin.metatrafficMulticastLocatorList.push_back(
        locator(discovery_group, discovery_port(domain)));
  }
  if (!address.empty()) {
    wire.default_unicast_locator_list.push_back(own);
  }
}

void set_discovery(int domain, bool multicast, const std::string& own_address,
                   const std::vector<std::string>& peers, dds::DomainParticipantQos& qos) {
  auto& builtin = qos.wire_protocol().builtin;
  builtin.discovery_config.leaseDuration = {static_cast<std::int32_t>(lease.count()), 0};
  builtin.discovery_config.leaseDuration_announcementperiod = {
      static_cast<std::int32_t>(lease_announcement.count()), 0};
  // The first is not sent (see screened_transport.hpp), and some get lost.
  builtin.discovery_config.initial_announcements = {10, {0, 50'000'000}};
  if (multicast) {
    builtin.initialPeersList.push_back(locator(discovery_group, discovery_port(domain)));
  }
  // The port is left to Fast DDS, which tries those of the first participants of the host. Its own
  // host is always a peer, so that programs on a machine without a network find each other.
  builtin.initialPeersList.push_back(locator(own_address, 0));
  for (const std::string& peer : peers) {
    builtin.initialPeersList.push_back(locator(peer, 0));
  }
}

std::string file_url(const std::filesystem::path& path) {
  return "file://" + std::filesystem::absolute(path).string();
}

void set_security(const SecurityFiles& files, dds::DomainParticipantQos& qos) {
  const auto set = [&](const std::string& name, const std::string& value) {
    qos.properties().properties().emplace_back("dds.sec." + name, value);
  };
  const std::string identity = "auth.builtin.PKI-DH.";
  const std::string access = "access.builtin.Access-Permissions.";
  set("auth.plugin", "builtin.PKI-DH");
  set(identity + "identity_ca", file_url(files.authority));
  set(identity + "identity_certificate", file_url(files.certificate));
  set(identity + "private_key", file_url(files.private_key));
  set(identity + "identity_crl", file_url(files.revoked));
  set("access.plugin", "builtin.Access-Permissions");
  set(access + "permissions_ca", file_url(files.authority));
  set(access + "governance", file_url(files.governance));
  set(access + "permissions", file_url(files.permissions));
  set("crypto.plugin", "builtin.AES-GCM-GMAC");
}

} // namespace

base::Expected<dds::DomainParticipantQos>
fast_dds_participant_qos(const ParticipantOptions& options, const SecurityFiles* security,
                         const std::shared_ptr<TransportState>& state) {
  auto* factory = dds::DomainParticipantFactory::get_instance();
  log_to_standard_error();
  factory->load_profiles();
  deliver_through_sockets_only();
  dds::DomainParticipantQos qos;
  factory->get_default_participant_qos(qos);
  qos.name(options.name);
#ifdef DYNCAL_FAST_DDS_3
  // Cyclone DDS refuses endpoints that carry information on their type.
  qos.properties().properties().emplace_back(dds::parameter_policy_type_propagation, "disabled");
#endif
  if (security != nullptr) {
    set_security(*security, qos);
  }
  if (!(factory->get_default_participant_qos() == dds::DomainParticipantQos())) {
    if (options.warn &&
        (!options.peers.empty() || !options.multicast || !options.interface_name.empty())) {
      options.warn("the profiles file of Fast DDS has a default participant profile: peers, "
                   "multicast and interface are taken from there");
    }
    for (auto& transport : qos.transport().user_transports) {
      transport = screened(transport, state);
    }
    return qos;
  }

  std::string address;
  if (!options.interface_name.empty()) {
    DYNCAL_TRY(address, interface_address(options.interface_name));
  }
  DYNCAL_TRY(const auto peers, resolve_peers(options.peers));

  const bool secured = security != nullptr;
  const bool has_long_packets = !secured && state->packet_bytes > max_udp_payload_bytes;
  set_transport(address, secured ? longest_payload_bytes : state->packet_bytes,
                has_long_packets ? long_packets_send_buffer_bytes : wanted_receive_buffer_bytes,
                options.screened ? state : nullptr, qos);
  const bool multicast = options.multicast && !is_loopback(address);
  set_locators(options.domain, multicast, address, qos);
  set_discovery(options.domain, multicast, address.empty() ? "127.0.0.1" : address, peers, qos);
  qos.allocation().locators.max_unicast_locators = locators_per_participant;
  if (const auto warning = receive_buffer_warning(
          wanted_receive_buffer_bytes, granted_receive_buffer(wanted_receive_buffer_bytes));
      !warning.empty() && options.warn) {
    options.warn(warning);
  }
  return qos;
}

} // namespace dyncal::bus
