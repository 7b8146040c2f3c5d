#include "services/programs/command/laboratory_look.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>

#include "services/base/version.hpp"
#include "services/bus/host_clocks/clock_messages.hpp"
#include "services/bus/host_network.hpp"
#include "services/checks/doctor/announcement_listener.hpp"
#include "services/checks/doctor/laboratory_watch.hpp"
#include "services/checks/doctor/unheard_analysis.hpp"
#include "services/security/strangers.hpp"

namespace dyncal::inline programs {
namespace {

// On busy computers two programs need some seconds to authenticate each other, and more where a
// message was lost; until then each takes the other for a stranger.
constexpr double authentication_s = 10.0;
constexpr double answer_s = 2.0; // of a program that has just been authenticated

// Looks at the laboratory for as long as the command says, and longer where a secured program has
// yet to authenticate another.
doctor::LaboratoryView look(doctor::LaboratoryWatch& watch, doctor::AnnouncementListener* listener,
                            double seconds, bool is_secured, const std::stop_token& stop) {
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  const auto passed_s = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
  double until_s = seconds;
  const auto goes_on = [&] {
    const double passed = passed_s();
    if (is_secured && !without_endpoints(watch.view().discovery).empty()) {
      until_s = std::clamp(passed + answer_s, until_s, seconds + authentication_s);
    }
    return passed < until_s;
  };
  while (!stop.stop_requested() && goes_on()) {
    watch.work();
    if (listener != nullptr) {
      listener->work();
    }
  }
  doctor::LaboratoryView view = watch.view();
  view.seconds = passed_s();
  return view;
}

// `interface`: the one that this program uses; empty: all.
void add_announcements(const std::vector<doctor::Announcement>& heard, const std::string& interface,
                       doctor::LaboratoryView& view) {
  view.announced_by_multicast.emplace();
  const auto is_here = [&](const doctor::Announcement& one) {
    return one.domain == view.domain && (interface.empty() || one.interface == interface);
  };
  for (const doctor::Announcement& one : heard) {
    if (is_here(one)) {
      view.announced_by_multicast->insert(one.participant);
      view.announced_from.insert(one.address);
      view.addresses[one.participant] = one.address;
      view.identities[one.participant] = one.identity;
    }
  }
  std::ranges::copy_if(
      heard, std::back_inserter(view.announced_elsewhere), [&](const doctor::Announcement& one) {
        return !is_here(one) && !view.announced_by_multicast->contains(one.participant);
      });
}

std::string interface_with(const std::string& address, const doctor::HostView& host) {
  const auto found = std::ranges::find(host.interfaces, address, &doctor::HostInterface::address);
  return found == host.interfaces.end() ? "" : found->name;
}

// Null where multicast is not to be used, or cannot be; then a finding says so.
std::optional<doctor::AnnouncementListener>
open_listener(const NetworkOptions& network, const std::string& address, Findings& findings) {
  if (network.no_multicast || address.starts_with("127.")) { // nothing is sent by multicast there
    return std::nullopt;
  }
  auto listener = doctor::AnnouncementListener::open(network.domain);
  if (!listener) {
    findings.push_back({Severity::warning, "multicast", listener.error().message});
    return std::nullopt;
  }
  return std::move(*listener);
}

// Those that announce programs; where there are none, as on an overloaded way to this host, those
// that were named.
std::set<std::string> silent_hosts(const LaboratoryLook& found, const NetworkOptions& network) {
  auto hosts = doctor::announcing_hosts(found.view, found.host);
  if (hosts.empty()) {
    const auto peers = bus::resolve_peers(network.peers).value_or(std::vector<std::string>());
    hosts.insert(peers.begin(), peers.end());
  }
  return hosts;
}

} // namespace

Expected<void> look_at_laboratory(const NetworkOptions& network, double seconds,
                                  const std::stop_token& stop,
                                  const std::function<void(const LaboratoryLook&)>& judge) {
  DYNCAL_TRY(auto participant, join_network(network, "dyncal-doctor", {.watch_discovery = true}));
  const auto own = this_program("dyncal-doctor", software_version(), network.dds);
  DYNCAL_TRY(auto watch, doctor::LaboratoryWatch::open(participant, own, bus::system_clock()));
  std::string address;
  if (!network.interface_name.empty()) {
    DYNCAL_TRY(address, bus::interface_address(network.interface_name));
  }
  LaboratoryLook found;
  auto listener = open_listener(network, address, found.about_multicast);
  found.host = doctor::look_at_host(".");
  found.host.used_address = address;
  found.view =
      look(*watch, listener ? &*listener : nullptr, seconds, !network.security.empty(), stop);
  found.host.udp_after = doctor::udp_counters();
  found.host.link_changes_after = doctor::link_changes();
  found.host.queues_after = doctor::send_queues();
  found.view.domain = network.domain;
  if (listener) {
    add_announcements(listener->heard(), interface_with(address, found.host), found.view);
  }
  if (!doctor::analysis_is_heard(found.view)) {
    found.host.tried = doctor::try_hosts(silent_hosts(found, network), stop);
  }
  judge(found);
  return {};
}

} // namespace dyncal::inline programs
