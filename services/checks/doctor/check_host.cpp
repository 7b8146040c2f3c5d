
#include <fmt/core.h>

#include "services/bus/host_network.hpp"
#include "services/bus/qos_profiles.hpp"
#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/host_view.hpp"

namespace dyncal::inline checks::doctor {
namespace {

constexpr int udp_and_ip_header_bytes = 28;
constexpr std::uint64_t little_space_bytes = std::uint64_t{1} << 30U;
constexpr std::uint64_t no_space_bytes = std::uint64_t{50} << 20U;

Finding check_buffers(const HostView& host) {
  const std::string warning =
      bus::receive_buffer_warning(bus::wanted_receive_buffer_bytes, host.receive_buffer_bytes);
  return warning.empty() ? Finding{Severity::ok, "buffers",
                                   fmt::format("a socket may have a receive buffer of {} bytes",
                                               host.receive_buffer_bytes)}
                         : Finding{Severity::warning, "buffers", warning};
}

Findings check_interfaces(const HostView& host) {
  Findings findings;
  constexpr int needed_mtu = bus::max_udp_payload_bytes + udp_and_ip_header_bytes;
  bool any = false;
  for (const HostInterface& one : host.interfaces) {
    any = any || !one.loopback;
    if (one.mtu < needed_mtu) {
      findings.push_back(
          {Severity::warning, "interfaces",
           fmt::format("{} ({}) has an MTU of {}: packets of {} bytes are cut into "
                       "fragments, and one that is lost costs all; set {} where the "
                       "network allows it",
                       one.name, one.address, one.mtu, bus::max_udp_payload_bytes, needed_mtu)});
    }
    if (!one.reaches_itself) {
      findings.push_back({Severity::error, "interfaces",
                          fmt::format("a datagram to our own address {} ({}) does not arrive; a "
                                      "firewall of this host drops it (nft list ruleset)",
                                      one.address, one.name)});
    }
  }
  if (!any) {
    findings.push_back({Severity::warning, "interfaces",
                        "this host has no network but loopback: programs of other hosts cannot "
                        "reach it"});
  }
  if (host.multicast_loops == false) {
    findings.push_back(
        {Severity::warning, "interfaces",
         "a multicast datagram of this host does not come back to it: programs on "
         "it find each other by unicast only; is there a route for 239.255.0.0/16?"});
  }
  if (findings.empty()) {
    std::string names;
    for (const HostInterface& one : host.interfaces) {
      names += (names.empty() ? "" : ", ") + fmt::format("{} {}", one.name, one.address);
    }
    findings.push_back({Severity::ok, "interfaces", names});
  }
  return findings;
}

Finding check_udp(const HostView& host) {
  if (!host.udp_before || !host.udp_after) {
    return {Severity::ok, "packets", "the counters of this host cannot be read"};
  }
  const std::uint64_t lost = host.udp_after->without_room - host.udp_before->without_room;
  const std::uint64_t damaged = host.udp_after->damaged - host.udp_before->damaged;
  const std::uint64_t received = host.udp_after->received - host.udp_before->received;
  if (lost > 0) {
    return {
        Severity::warning, "packets",
        fmt::format("{} UDP packets were dropped (socket buffer full) during the check ({} were "
                    "received); see 'buffers', or a program hangs",
                    lost, received)};
  }
  if (damaged > 0) {
    return {
        Severity::warning, "packets",
        fmt::format("{} UDP packets came damaged during the check ({} came whole); look at cable "
                    "and switch",
                    damaged, received)};
  }
  return {Severity::ok, "packets",
          fmt::format("{} UDP packets came while I looked, none was lost in this host{}", received,
                      host.udp_after->without_room > 0
                          ? fmt::format(" ({} since it was started)", host.udp_after->without_room)
                          : "")};
}

Finding check_space(const HostView& host) {
  const std::string folder = host.output_folder.string();
  if (!host.output_writable) {
    return {
        Severity::warning, "disk",
        fmt::format("results cannot be written into {}; run dyncal where you may write", folder)};
  }
  if (!host.free_bytes) {
    return {Severity::ok, "disk", "the free space of " + folder + " is not known"};
  }
  const std::uint64_t free_mb = *host.free_bytes >> 20U;
  if (*host.free_bytes < little_space_bytes) {
    return {*host.free_bytes < no_space_bytes ? Severity::error : Severity::warning, "disk",
            fmt::format("only {} MB are free in {}; make room before a run", free_mb, folder)};
  }
  return {Severity::ok, "disk", fmt::format("{} MB are free in {}", free_mb, folder)};
}

} // namespace

Findings check_host(const HostView& host, int domain) {
  Findings findings{check_buffers(host)};
  const Findings interfaces = check_interfaces(host);
  append(findings, interfaces);
  findings.push_back(check_udp(host));
  findings.push_back(check_space(host));
  constexpr int domains_below_ephemeral_ports = 100;
  if (domain > domains_below_ephemeral_ports) {
    findings.push_back({Severity::warning, "domain",
                        fmt::format("the ports of DDS domain {} may be taken by other programs of "
                                    "this host (net.ipv4.ip_local_port_range); take one below {}",
                                    domain, domains_below_ephemeral_ports)});
  }
  return findings;
}

} // namespace dyncal::inline checks::doctor
