#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "services/doctor/checks.hpp"

namespace dyncal::services::doctor {
namespace {

constexpr double notable_offset_s = 1.0; // log lines of two hosts no longer fit together

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
  for (const HeardProgram& program : view.programs) {
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

// Others in the domain, such as tools of others, or `dyncal run`.
Findings check_others(const LaboratoryView& view) {
  std::set<std::string> services;
  for (const HeardProgram& program : view.programs) {
    services.insert(program.identity.program);
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
  const auto analyses = std::ranges::count_if(view.programs, [](const HeardProgram& program) {
    return program.identity.program == "dyncal-analysis";
  });
  if (analyses == 0 && view.analyses.empty()) {
    const bool empty = view.programs.empty() && view.sources.empty();
    return {{Severity::warning, "analysis",
             empty ? "no analysis service either"
                   : "no analysis service is there; start dyncal-analysis on one machine of the "
                     "laboratory"}};
  }
  return {{Severity::ok, "analysis",
           fmt::format("{} analysis service{}", std::max<std::ptrdiff_t>(analyses, 1),
                       analyses > 1 ? "s" : "")}};
}

// Versions that differ, of all that say theirs.
Findings check_versions(const LaboratoryView& view) {
  std::set<std::string> software{view.own.software};
  std::set<std::uint32_t> contracts{wire::CONTRACT_VERSION};
  for (const HeardProgram& program : view.programs) {
    software.insert(program.identity.software);
    contracts.insert(program.contract_version);
  }
  for (const auto& [key, source] : view.sources) {
    if (source.description) {
      software.insert(source.description->software());
      contracts.insert(source.description->contract_version());
    }
  }
  Findings findings;
  if (contracts.size() > 1) {
    findings.push_back({Severity::problem, "versions",
                        fmt::format("programs speak versions {} of the contract; what a newer one "
                                    "adds is not seen by the older: install the same version of "
                                    "dyncal everywhere",
                                    fmt::join(contracts, " and "))});
  }
  if (software.size() > 1) {
    findings.push_back(
        {Severity::warning, "versions",
         fmt::format("programs are of different versions: {}; install the same everywhere",
                     fmt::join(software, ", "))});
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
    const bool far = std::abs(host.clock.offset_s) - host.clock.bound_s > notable_offset_s;
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

} // namespace

Findings check_programs(const LaboratoryView& view) {
  Findings findings = check_presence(view);
  for (const auto& check : {check_others, check_analysis, check_versions, check_clocks}) {
    const Findings more = check(view);
    findings.insert(findings.end(), more.begin(), more.end());
  }
  return findings;
}

} // namespace dyncal::services::doctor
