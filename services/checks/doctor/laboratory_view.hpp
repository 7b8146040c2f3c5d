// What was observed of a laboratory on the bus, for the judges of checks.hpp. Plain data; nothing
// in it is judged.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "services/bus/discovery.hpp"
#include "services/bus/host_clocks/clock_asker.hpp"
#include "services/bus/host_clocks/link_meter.hpp"
#include "services/checks/doctor/announcement_listener.hpp"
#include "services/network/bench.hpp"

namespace dyncal::inline checks::doctor {

struct LaboratoryView {
  using Key = std::pair<std::string, std::string>; // bench; source or service

  int domain = 0;
  double seconds = 0.0; // for which was looked
  ProgramIdentity own;  // the doctor
  std::map<Key, network::Source> sources;
  std::map<Key, std::set<std::string>> senders; // participants that a source's statuses came from
  std::map<std::string, network::Service> analyses; // by their names
  std::map<Key, network::Service> guards;
  std::vector<DiscoveredProgram> programs; // that answer
  std::vector<HostClock> clocks;
  std::vector<LinkLoss> losses; // one of each of the programs
  bus::Discovery discovery;
  // Participants whose multicast announcements came; nothing: it could not be listened for.
  std::optional<std::set<std::string>> announced_by_multicast;
  std::set<std::string> announced_from; // addresses that those came from
  // Of other domains, and of this one by interfaces that this program does not use.
  std::vector<Announcement> announced_elsewhere;
  std::map<std::string, std::string> addresses;        // of participants that announced themselves
  std::map<std::string, AnnouncedIdentity> identities; // of those
  std::uint64_t malformed_messages = 0;
};

} // namespace dyncal::inline checks::doctor
