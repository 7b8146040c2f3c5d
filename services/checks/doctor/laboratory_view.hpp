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

#include "idl/dyncal.h"
#include "services/bus/discovery.hpp"
#include "services/bus/host_clocks/clock_asker.hpp"
#include "services/bus/host_clocks/link_meter.hpp"

namespace dyncal::inline checks::doctor {

// A source, by what it publishes of itself.
struct ObservedSource {
  std::optional<wire::SourceDescription> description; // the newest
  std::optional<wire::SourceStatus> first_status;     // since the doctor looks
  std::optional<wire::SourceStatus> status;           // the newest
  std::set<std::string> writers; // hosts and processes that describe it, "lab-2:4711"
  bool twins = false;            // two services take turns as this source
};

struct LaboratoryView {
  using SourceKey = std::pair<std::string, std::string>; // bench, source

  int domain = 0;
  double seconds = 0.0; // for which was looked
  ProgramIdentity own;  // the doctor
  std::map<SourceKey, ObservedSource> sources;
  std::map<std::string, wire::ServiceStatus> analyses; // by their names, the newest of each
  std::map<std::string, wire::ServiceStatus> guards;   // by bench and name, "acc-1 guard@lab-1:7"
  std::vector<DiscoveredProgram> programs;             // that answer
  std::vector<HostClock> clocks;
  std::vector<LinkLoss> losses; // one of each of the programs
  bus::Discovery discovery;
  // Participants whose multicast announcements came; nothing: it could not be listened for.
  std::optional<std::set<std::string>> announced_by_multicast;
  std::set<std::string> announced_from; // addresses that those came from
  std::uint64_t malformed_messages = 0;
};

} // namespace dyncal::inline checks::doctor
