#include "services/checks/doctor/unheard_analysis.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "services/checks/doctor/announced_elsewhere.hpp"

namespace dyncal::inline checks::doctor {
namespace {

constexpr const char* analysis_program = "dyncal-analysis";
// Of probes without echo, or trials missed; runs begin at 20 %, a sound link has 0.
constexpr double bad_link = 0.05;
constexpr std::uint64_t fewest_drops = 20; // that are no chance of some large transfer

std::set<std::string> own_addresses(const HostView& host) {
  std::set<std::string> addresses;
  for (const HostInterface& one : host.interfaces) {
    addresses.insert(one.address);
  }
  return addresses;
}

std::string this_host(const HostView& host) {
  std::vector<std::string> names;
  for (const HostInterface& one : host.interfaces) {
    if (!one.loopback) {
      names.push_back(fmt::format("{} ({})", one.address, one.name));
    }
  }
  return names.empty() ? "" : fmt::format("this host is {}", fmt::join(names, ", "));
}

std::string about_no_address(const HostView& host) {
  return "this host has no IPv4 address but that of loopback" +
         (host.without_ipv4.empty()
              ? std::string(": is its network up?")
              : fmt::format("; {} has IPv6 alone, which is not used: give it an IPv4 address",
                            fmt::join(host.without_ipv4, ", ")));
}

// Empty where the links of this host were steady.
std::string about_flapping(const HostView& host) {
  for (const auto& [name, changes] : host.link_changes_after) {
    const auto before = host.link_changes_before.find(name);
    if (before != host.link_changes_before.end() && changes > before->second) {
      return fmt::format("the link of {} went down or came back {} times meanwhile: look at cable "
                         "and switch",
                         name, changes - before->second);
    }
  }
  return "";
}

bool answers(const LaboratoryView& view, const std::string& program) {
  return std::ranges::any_of(view.programs,
                             [&](const auto& one) { return one.identity.program == program; });
}

bool is_found(const LaboratoryView& view, const std::string& program) {
  return std::ranges::any_of(view.discovery.participants, [&](const auto& one) {
    return one.name == program || one.name.starts_with(program + ":");
  });
}

double worst_loss(const LaboratoryView& view) {
  double worst = 0.0;
  for (const LinkLoss& loss : view.losses) {
    worst = std::max(worst, lost_part(loss).value_or(0.0));
  }
  return worst;
}

// Empty where what this host sent found room.
std::string about_full_queue(const HostView& host) {
  for (const auto& [name, after] : host.queues_after) {
    const auto before = host.queues_before.find(name);
    if (before == host.queues_before.end()) {
      continue;
    }
    const std::uint64_t dropped = after.dropped - before->second.dropped;
    const std::uint64_t sent = after.sent - before->second.sent;
    const double part = static_cast<double>(dropped) / static_cast<double>(dropped + sent + 1);
    if (dropped >= fewest_drops && part > bad_link) {
      return fmt::format("the link of {0} is overloaded: {1:.0f} % of what this host sent found no "
                         "room in its queue (`tc -s qdisc show dev {0}`)",
                         name, 100.0 * part);
    }
  }
  return "";
}

// Empty where trial connections show nothing of it.
std::string about_bad_link(const HostView& host) {
  for (const auto& [address, tried] : host.tried) {
    if (tried.in_time + tried.late > 0 && tried.missed_part() > bad_link) {
      return fmt::format("the link is overloaded or bad: of {} trial connections to {} {} were "
                         "answered in time, {} late, the others not",
                         tried.begun, address, tried.in_time, tried.late);
    }
  }
  return "";
}

bool is_in_a_subnet(const std::string& address, const HostView& host) {
  in_addr other{};
  inet_pton(AF_INET, address.c_str(), &other);
  return std::ranges::any_of(host.interfaces, [&](const HostInterface& one) {
    in_addr own{};
    inet_pton(AF_INET, one.address.c_str(), &own);
    const std::uint64_t differing = ntohl(own.s_addr) ^ ntohl(other.s_addr);
    return (differing >> (32 - one.prefix_bits)) == 0;
  });
}

// Why what this host sends to one that was tried takes another way, or none; empty if it need not.
std::string about_way(const LaboratoryView& view, const HostView& host) {
  for (const auto& [address, tried] : host.tried) {
    if (tried.has_no_route) {
      return fmt::format("this host has no route to {0}: give both addresses of one network, or a "
                         "route (`ip route get {0}`)",
                         address);
    }
    if (!host.used_address.empty() && !tried.own_address.empty() &&
        tried.own_address != host.used_address) {
      return fmt::format("{} is reached by {}, and this program uses {} alone: another --interface",
                         address, tried.own_address, host.used_address);
    }
    if (tried.in_time + tried.late == 0 && view.announced_from.contains(address) &&
        !is_in_a_subnet(address, host)) {
      return fmt::format("{0} is at this network, but of another subnet than this host: give both "
                         "addresses of one subnet, or a route (`ip route get {0}`)",
                         address);
    }
  }
  return "";
}

// Why packets of hosts come, but no answer.
std::string about_no_answer(const LaboratoryView& view, const HostView& host) {
  if (std::string bad = about_bad_link(host); !bad.empty()) {
    return bad;
  }
  if (std::string way = about_way(view, host); !way.empty()) {
    return way;
  }
  if (host.tried.empty()) {
    return "what this host sends does not arrive there (a firewall, a way that is cut in one "
           "direction, or a link that is overloaded)";
  }
  for (const auto& [address, tried] : host.tried) {
    if (tried.in_time == 0) {
      return fmt::format("what this host sends does not arrive there, or nothing comes back; not "
                         "one of {} trial connections to {} was answered: a firewall, or a way "
                         "that is cut in one direction",
                         tried.begun, address);
    }
  }
  return "trial connections by TCP are answered at once, so the link is sound: a firewall, here or "
         "there, does not let UDP through, an MTU below 1500 on the way drops longer packets, or "
         "the "
         "program hangs";
}

std::string about_others(const LaboratoryView& view, const HostView& host) {
  if (const double lost = worst_loss(view); lost > bad_link) {
    return fmt::format("{:.0f} % of the probes from this host to the others bring no echo: the "
                       "link is overloaded or bad",
                       100.0 * lost);
  }
  if (answers(view, analysis_program)) {
    return "a dyncal-analysis answers now, which did not in time: it was started late, or the link "
           "was interrupted or overloaded";
  }
  const std::set<std::string> hosts = announcing_hosts(view, host);
  const std::string elsewhere = announced_elsewhere(view);
  if (view.programs.empty() && hosts.empty() && !elsewhere.empty()) {
    return fmt::format("nothing answers in DDS domain {}: {}", view.domain, elsewhere);
  }
  const std::string where = hosts.empty() ? "" : fmt::format(" from {}", fmt::join(hosts, ", "));
  if (is_found(view, analysis_program) || (view.programs.empty() && !hosts.empty())) {
    return fmt::format("announcements come{}{}, but no answer: {}", where,
                       is_found(view, analysis_program) ? ", of a dyncal-analysis too" : "",
                       about_no_answer(view, host));
  }
  if (!view.programs.empty()) {
    std::set<std::string> names;
    for (const DiscoveredProgram& one : view.programs) {
      names.insert(fmt::format("{} on {}", one.identity.program, one.identity.host));
    }
    return fmt::format("{} answer{}, but no dyncal-analysis is among them: {}",
                       fmt::join(names, ", "), names.size() == 1 ? "s" : "",
                       elsewhere.empty() ? "start one" : elsewhere);
  }
  std::string cause = about_way(view, host); // to a peer that was named
  if (cause.empty()) {
    cause = about_bad_link(host);
  }
  return fmt::format("nothing is heard in DDS domain {}{}: {}", view.domain,
                     view.announced_by_multicast ? ", by multicast neither" : "",
                     cause.empty() ? "where the network carries no multicast, each program needs "
                                     "--peer with the address of the others"
                                   : cause);
}

} // namespace

std::set<std::string> announcing_hosts(const LaboratoryView& view, const HostView& host) {
  std::set<std::string> others;
  std::ranges::set_difference(view.announced_from, own_addresses(host),
                              std::inserter(others, others.end()));
  return others;
}

bool analysis_is_heard(const LaboratoryView& view) {
  return answers(view, analysis_program) || !view.analyses.empty();
}

std::string why_no_analysis_is_heard(const LaboratoryView& view, const HostView& host) {
  const std::string own = this_host(host);
  if (own.empty() && view.programs.empty()) {
    return about_no_address(host);
  }
  std::string why = about_flapping(host);
  if (why.empty()) {
    why = about_full_queue(host);
  }
  if (why.empty()) {
    why = about_others(view, host);
  }
  return own.empty() ? why : why + "; " + own;
}

} // namespace dyncal::inline checks::doctor
