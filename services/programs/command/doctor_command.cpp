// `dyncal doctor`: who is on the network, what does not fit together, and what to do about it
// (services/checks/doctor). Works where nothing is on the network, too.
//
// The exit status is for monitoring: 0 nothing is wrong, 3 problems, 4 it could not look, 5
// warnings and no problem. Belongs to one thread.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/printable_text.hpp"
#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/dds_variables.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "services/checks/doctor/report.hpp"
#include "services/checks/doctor/unheard_analysis.hpp"
#include "services/daemon/program/bench_program.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/laboratory_look.hpp"
#include "services/security/identity_folder.hpp"
#include "services/security/revoked_participants.hpp"
#include "services/security/strangers.hpp"

namespace dyncal::inline programs {
namespace {

struct DoctorOptions {
  std::string bench_file; // empty: none to compare with
  double seconds = 5.0;
  bool json = false;
  NetworkOptions network;
};

void add_doctor(CLI::App& command, DoctorOptions& doctor) {
  command.add_option("BENCH.toml", doctor.bench_file,
                     "bench file that the services should have read");
  add_default(command, "--seconds", doctor.seconds, "look for this time", CLI::PositiveNumber);
  command.add_flag("--json", doctor.json, "print JSON");
  command.footer("Exit status: 0 nothing is wrong, 2 wrong command line, 3 problems, 4 the bench "
                 "file or the network cannot be used, 5 warnings and no problem.");
  add_network_options(command, doctor.network);
}

Expected<std::optional<BenchFile>> read_bench(DoctorOptions& command) {
  if (command.bench_file.empty()) {
    return std::optional<BenchFile>();
  }
  DYNCAL_TRY(auto bench, read_bench_file(command.bench_file));
  add_network_settings(bench.network, command.network);
  return std::optional<BenchFile>(std::move(bench));
}

// Why an announcement keeps its program from talking to one with `own` and the governance of
// 'dyncal security init'.
std::string reason_of(const doctor::AnnouncedIdentity& identity, const std::string& own) {
  constexpr std::uint64_t usual_protection = 0x8000'0006'8000'0006U; // discovery and liveliness
  if (!identity.authority.empty() && identity.authority != own) {
    return "of the authority " + one_line(identity.authority);
  }
  return identity.protection && *identity.protection != usual_protection ? "of another governance"
                                                                         : "";
}

// Takes those out of the view that announce themselves and show nothing else: a secured program has
// not authenticated them. Others would be looked for in the network.
std::vector<Stranger> take_out_strangers(const NetworkOptions& network,
                                         doctor::LaboratoryView& view) {
  const auto start = own_guid_start(network.security, *bus::parse_vendor(network.dds));
  const std::string own = start ? bus::hexadecimal(start->data(), start->size()) : "";
  const std::string authority = authority_of(network.security);
  std::vector<Stranger> strangers = without_endpoints(view.discovery);
  std::set<std::string> known;
  for (const auto& participant : view.discovery.participants) {
    known.insert(participant.id);
  }
  for (const std::string& id : view.announced_by_multicast.value_or(std::set<std::string>())) {
    if (!known.contains(id) && !id.starts_with(own)) {
      strangers.push_back({id, view.addresses[id]});
    }
  }
  for (Stranger& one : strangers) {
    one.reason = reason_of(view.identities[one.id], authority);
    std::erase_if(view.discovery.participants,
                  [&](const auto& other) { return other.id == one.id; });
    if (view.announced_by_multicast) {
      view.announced_by_multicast->erase(one.id);
    }
  }
  return strangers;
}

// Nothing to say on a computer alone.
Findings about_security(const NetworkOptions& network, const std::vector<Stranger>& strangers,
                        const doctor::HostView& host) {
  if (!network.security.empty()) {
    Findings findings{
        {Severity::ok, "security", "encrypted, among programs of this laboratory alone"}};
    if (!strangers.empty()) {
      const auto files = security_files(network.security, *bus::parse_vendor(network.dds));
      findings.push_back(
          {Severity::warning, "security", strangers_sentence(strangers, files.revoked)});
    }
    return findings;
  }
  if (std::ranges::all_of(host.interfaces, &doctor::HostInterface::loopback)) {
    return {};
  }
  return {{Severity::note, "security",
           "none: whoever is on this network can read and send everything; 'dyncal security' and "
           "--security keep others out"}};
}

Findings judge(const LaboratoryLook& look, const NetworkOptions& network,
               const std::optional<BenchFile>& bench) {
  doctor::LaboratoryView view = look.view;
  const auto strangers =
      network.security.empty() ? std::vector<Stranger>() : take_out_strangers(network, view);
  Findings findings = doctor::check_programs(view);
  if (!doctor::analysis_is_heard(view)) {
    findings.push_back(
        {Severity::warning, "analysis", doctor::why_no_analysis_is_heard(view, look.host)});
  }
  append(findings, doctor::check_sources(view, bench));
  append(findings, doctor::check_guards(view, bench));
  append(findings, doctor::check_endpoints(view, bench ? std::vector{bench->bench}
                                                       : std::vector<std::string>()));
  append(findings, look.about_multicast);
  append(findings, doctor::check_network(view));
  append(findings, doctor::check_vendors(view, network.vendors == "same"));
  append(findings, doctor::check_loss(view));
  append(findings, about_security(network, strangers, look.host));
  append(findings, doctor::check_variables(view, look.host));
  append(findings, doctor::check_host(look.host, view.domain));
  return findings;
}

int status_of(const Findings& findings) {
  constexpr int only_warnings = 5;
  const Severity gravest = worst(findings);
  return gravest >= Severity::error     ? problems_found
         : gravest >= Severity::warning ? only_warnings
                                        : 0;
}

// Ends the program where there is something to judge.
Expected<void> look_and_judge(DoctorOptions& command, const std::stop_token& stop) {
  DYNCAL_TRY(const auto bench, read_bench(command));
  return look_at_laboratory(
      command.network, command.seconds, stop, [&](const LaboratoryLook& look) {
        const Findings findings = judge(look, command.network, bench);
        fmt::print("{}", command.json ? json_text(doctor::as_json(findings, look.view), 2) + "\n"
                                      : doctor::as_text(findings));
        std::fflush(stdout);
        std::_Exit(status_of(findings));
      });
}

Expected<int> run_doctor(DoctorOptions& command, const std::stop_token& stop) {
  const int status = report_error(look_and_judge(command, stop).error());
  return status == 1 ? could_not_look : status;
}

const Command doctor_command{70, "doctor", "diagnose the laboratory, the network and this host",
                             add_doctor, run_doctor};

} // namespace
} // namespace dyncal::inline programs
