#include <algorithm>

#include <fmt/core.h>

#include "services/bus/qos_profiles.hpp"
#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"

namespace dyncal::inline checks::doctor {
namespace {

constexpr int base_port = 7400;
constexpr int ports_per_domain = 250;

struct Ports {
  int first;
  int last;
};

Ports port_range(int domain) {
  const int first = base_port + ports_per_domain * domain;
  return {first, first + 11 + 2 * (bus::participants_per_host - 1)};
}

std::string ports_of(int domain) {
  const Ports ports = port_range(domain);
  return fmt::format("UDP {} to {}", ports.first, ports.last);
}

std::string name_of(const bus::DiscoveredParticipant& participant) {
  return participant.name.empty() ? "a program with " + participant.vendor : participant.name;
}

Finding check_multicast(const LaboratoryView& view) {
  if (!view.announced_by_multicast) {
    return {Severity::ok, "multicast", "not looked at: this program does without (--no-multicast)"};
  }
  const auto& announced = *view.announced_by_multicast;
  std::string missing;
  std::size_t missing_count = 0;
  for (const bus::DiscoveredParticipant& participant : view.discovery.participants) {
    if (!announced.contains(participant.id)) {
      missing += (missing.empty() ? "" : ", ") + name_of(participant);
      ++missing_count;
    }
  }
  if (missing_count == 0) {
    return {Severity::ok, "multicast",
            fmt::format("announcements of all {} participants came by multicast",
                        view.discovery.participants.size())};
  }
  return {Severity::warning, "multicast",
          fmt::format("no multicast comes from {}, found by unicast: started with "
                      "--no-multicast, or the network does not carry multicast (then give every "
                      "program --peer)",
                      missing)};
}

// Announced, so there, but what it has does not come.
Findings check_unicast(const LaboratoryView& view) {
  Findings findings;
  for (const bus::DiscoveredParticipant& participant : view.discovery.participants) {
    const bool known = std::ranges::any_of(view.discovery.endpoints, [&](const auto& endpoint) {
      return endpoint.participant == participant.id;
    });
    if (!known) {
      findings.push_back(
          {Severity::warning, "network",
           fmt::format("{} ({}) is announced, but none of its writers and readers is known: "
                       "unicast from or to it does not get through, or it has none; a firewall on "
                       "either host must let {} through",
                       name_of(participant), participant.vendor, ports_of(view.domain))});
    }
  }
  const bool others = !view.discovery.participants.empty();
  if (others && view.programs.empty() && !view.discovery.endpoints.empty()) {
    findings.push_back(
        {Severity::error, "network",
         fmt::format("programs are found, but no answer comes from any: their packets with "
                     "messages do not get through; a firewall on either host must let {} through, "
                     "or an MTU below 1500 on the way, or at the other host, drops longer ones",
                     ports_of(view.domain))});
  }
  return findings;
}

std::string sender_of_packets(const DiscoveredProgram& program, int domain) {
  if (!program.packets_refused_from.empty()) {
    return "the last one came from " + program.packets_refused_from;
  }
  const Ports ports = port_range(domain);
  return fmt::format("`tcpdump -n udp portrange {}-{}` there shows who sends", ports.first,
                     ports.last);
}

// Malformed packets that programs have refused.
Findings check_packets(const LaboratoryView& view) {
  Findings findings;
  for (const DiscoveredProgram& program : view.programs) {
    if (program.packets_refused == 0) {
      continue;
    }
    findings.push_back(
        {Severity::warning, "packets",
         fmt::format("{}:{} on {} has refused {} malformed packets since its start, {} of them in "
                     "these {:.0f} s; {}; no program of a laboratory sends such packets: end what "
                     "does, or let a firewall pass only your own hosts to {}",
                     program.identity.program, program.identity.process_id, program.identity.host,
                     program.packets_refused, program.packets_refused_now, view.seconds,
                     sender_of_packets(program, view.domain), ports_of(view.domain))});
  }
  return findings;
}

} // namespace

Findings check_network(const LaboratoryView& view) {
  Findings findings{check_multicast(view)};
  const Findings unicast = check_unicast(view);
  append(findings, unicast);
  if (unicast.empty() && !view.programs.empty()) {
    findings.push_back({Severity::ok, "network",
                        fmt::format("messages of {} programs get through; DDS domain {} uses {}",
                                    view.programs.size(), view.domain, ports_of(view.domain))});
  }
  const Findings packets = check_packets(view);
  append(findings, packets);
  if (view.malformed_messages > 0) {
    findings.push_back({Severity::warning, "network",
                        fmt::format("{} messages do not match the contract and were dropped; which "
                                    "program writes them? 'versions' and 'endpoints' may tell",
                                    view.malformed_messages)});
  }
  return findings;
}

} // namespace dyncal::inline checks::doctor
