#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "idl/dyncal.h"
#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "services/checks/doctor/unheard_analysis.hpp"

namespace dyncal::inline checks::doctor {
namespace {

std::string place_of(const ProgramIdentity& identity) {
  return fmt::format("{}:{} on {}", identity.program, identity.process_id, identity.host);
}

Findings check_presence(const LaboratoryView& view) {
  if (view.programs.empty() && view.sources.empty() && view.discovery.participants.empty()) {
    return {{Severity::warning, "programs",
             fmt::format("nothing is on DDS domain {} for {:.0f} s; is --domain right, and do the "
                         "services run?",
                         view.domain, view.seconds)}};
  }
  Findings findings;
  for (const DiscoveredProgram& program : view.programs) {
    findings.push_back({Severity::ok, "programs",
                        fmt::format("{}: {}, {}", place_of(program.identity),
                                    program.identity.software, program.identity.dds)});
  }
  if (view.programs.empty()) {
    findings.push_back({Severity::warning, "programs",
                        "no service of dyncal answers, although others are in this domain; see "
                        "'network' below"});
  }
  return findings;
}

// Others in the domain, such as tools of others, or `dyncal run`. Not every DDS library announces
// process and host.
Findings check_others(const LaboratoryView& view) {
  std::set<std::string> services;
  for (const DiscoveredProgram& program : view.programs) {
    services.insert({program.identity.program, place_of(program.identity)});
  }
  std::set<std::string> others;
  for (const bus::DiscoveredParticipant& one : view.discovery.participants) {
    if (!services.contains(one.name)) {
      others.insert(
          fmt::format("{} ({})", one.name.empty() ? "without a name" : one.name, one.vendor));
    }
  }
  if (others.empty()) {
    return {};
  }
  return {
      {Severity::ok, "programs", fmt::format("also in this domain: {}", fmt::join(others, ", "))}};
}

Findings check_analysis(const LaboratoryView& view) {
  if (!analysis_is_heard(view)) {
    const bool empty = view.programs.empty() && view.sources.empty();
    return {{Severity::warning, "analysis",
             empty ? "no analysis service either"
                   : "no analysis service is there; start dyncal-analysis on one machine of the "
                     "laboratory"}};
  }
  const auto analyses = std::ranges::count_if(view.programs, [](const DiscoveredProgram& program) {
    return program.identity.program == "dyncal-analysis";
  });
  return {{Severity::ok, "analysis",
           fmt::format("{} analysis service{}", std::max<std::ptrdiff_t>(analyses, 1),
                       analyses > 1 ? "s" : "")}};
}

// A version of software or contract, and where it runs.
template <class Version>
using Places = std::map<Version, std::set<std::string>>;

struct Versions {
  Places<std::string> software;
  Places<std::uint32_t> contracts;
};

// Of all that say theirs. A service that answers also describes sources or reports on runs; that
// what it says there is another version tells of a second program in its place.
Versions versions_of(const LaboratoryView& view) {
  Versions versions;
  const auto add = [&](const std::string& program, const std::string& host,
                       const std::string& software, std::uint32_t contract) {
    const std::string place = fmt::format("{}@{}", program, host);
    versions.software[software].insert(place);
    versions.contracts[contract].insert(place);
  };
  add(view.own.program, view.own.host, view.own.software, wire::CONTRACT_VERSION);
  for (const DiscoveredProgram& program : view.programs) {
    const ProgramIdentity& identity = program.identity;
    add(identity.program, identity.host, identity.software, program.contract_version);
  }
  const auto name_of = [&](const std::string& host, std::uint32_t process_id,
                           const std::string& otherwise) {
    const auto program = std::ranges::find_if(view.programs, [&](const DiscoveredProgram& one) {
      return one.identity.host == host && one.identity.process_id == process_id;
    });
    return program == view.programs.end() ? otherwise : program->identity.program;
  };
  for (const auto& [key, source] : view.sources) {
    if (source.description) {
      const std::string name = fmt::format("the source {}/{}", key.first, key.second);
      add(name_of(source.host, source.process_id, name), source.host, source.software,
          source.contract_version);
    }
  }
  for (const auto& [service, analysis] : view.analyses) {
    add(name_of(analysis.host, analysis.process_id, service.substr(0, service.find(':'))),
        analysis.host, analysis.software, analysis.contract_version);
  }
  return versions;
}

// "dyncal 0.1.0 (dyncal-acs@lab-2), dyncal 0.2.0 (dyncal-dau@lab-1, dyncal-doctor@lab-1)"
template <class Version>
std::string text_of(const Places<Version>& versions) {
  constexpr std::size_t max_named = 8; // of each
  std::vector<std::string> texts;
  for (const auto& [version, places] : versions) {
    std::vector<std::string> named;
    for (const std::string& place : places) {
      if (named.size() == max_named) {
        named.push_back(fmt::format("{} more", places.size() - max_named));
        break;
      }
      named.push_back(place);
    }
    texts.push_back(fmt::format("{} ({})", version, fmt::join(named, ", ")));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

Findings check_versions(const LaboratoryView& view) {
  const Versions versions = versions_of(view);
  Findings findings;
  if (versions.contracts.size() > 1) {
    findings.push_back({Severity::error, "versions",
                        fmt::format("programs speak different versions of the contract: {}; what a "
                                    "newer one adds is not seen by the older: install the same "
                                    "version of dyncal everywhere",
                                    text_of(versions.contracts))});
  }
  if (versions.software.size() > 1) {
    findings.push_back(
        {Severity::warning, "versions",
         fmt::format("programs are of different versions: {}; install the same everywhere",
                     text_of(versions.software))});
  }
  if (findings.empty()) {
    findings.push_back(
        {Severity::ok, "versions", "the same software everywhere: " + view.own.software});
  }
  return findings;
}

Findings check_clocks(const LaboratoryView& view) {
  Findings findings;
  for (const HostClock& host : view.clocks) {
    const bool far = is_notable(host.clock);
    findings.push_back(
        {far ? Severity::warning : Severity::ok, "clocks",
         fmt::format("the clock of {} is {:+.6f} s from ours, within {:.6f} s{}", host.host,
                     host.clock.offset_s, host.clock.bound_s,
                     far ? "; no result depends on it, but log lines of the two do not fit "
                           "together: let both follow NTP"
                         : "")});
  }
  if (findings.empty()) {
    findings.push_back({Severity::ok, "clocks", "no other host whose clock could differ"});
  }
  return findings;
}

// A computer has one clock. Programs whose clocks differ, whatever the way of the messages took,
// are on several, as when an image was copied: what goes by their names then takes them for one.
Findings check_host_names(const LaboratoryView& view) {
  struct Clocks {
    double latest_begin_s = 0.0; // of what the offsets leave open
    double earliest_end_s = 0.0;
    std::string of_latest;
    std::string of_earliest;
  };
  constexpr double reading_s = 1e-3; // of a clock that is being set
  std::map<std::string, Clocks> hosts;
  const std::string ours = service_name(view.own);
  hosts[view.own.host] = {0.0, 0.0, ours, ours};
  for (const DiscoveredProgram& program : view.programs) {
    if (!program.clock) {
      continue;
    }
    const double begin_s = program.clock->offset_s - program.clock->bound_s;
    const double end_s = program.clock->offset_s + program.clock->bound_s;
    const std::string name = service_name(program.identity);
    Clocks& clocks =
        hosts.try_emplace(program.identity.host, Clocks{begin_s, end_s, name, name}).first->second;
    if (begin_s > clocks.latest_begin_s) {
      clocks.latest_begin_s = begin_s;
      clocks.of_latest = name;
    }
    if (end_s < clocks.earliest_end_s) {
      clocks.earliest_end_s = end_s;
      clocks.of_earliest = name;
    }
  }
  Findings findings;
  for (const auto& [host, clocks] : hosts) {
    if (const double apart_s = clocks.latest_begin_s - clocks.earliest_end_s; apart_s > reading_s) {
      findings.push_back({Severity::warning, "host names",
                          fmt::format("'{}' is the name of two computers: the clocks of {} and {} "
                                      "are {:.3f} s apart or more; give each its own name",
                                      host, clocks.of_latest, clocks.of_earliest, apart_s)});
    }
  }
  return findings;
}

} // namespace

Findings check_programs(const LaboratoryView& view) {
  Findings findings = check_presence(view);
  for (const auto& check :
       {check_others, check_analysis, check_versions, check_clocks, check_host_names}) {
    append(findings, check(view));
  }
  return findings;
}

} // namespace dyncal::inline checks::doctor
