#include "services/command/doctor_command.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/bus/host_network.hpp"
#include "services/doctor/announcement_listener.hpp"
#include "services/doctor/checks.hpp"
#include "services/doctor/laboratory_watch.hpp"
#include "services/doctor/report.hpp"
#include "services/json_text.hpp"
#include "services/program/bench_program.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

using doctor::Findings;
using doctor::Severity;

void append(Findings& findings, const Findings& more) {
  findings.insert(findings.end(), more.begin(), more.end());
}

// Looks at the laboratory for as long as the command says.
doctor::LaboratoryView look(doctor::LaboratoryWatch& watch, doctor::AnnouncementListener* listener,
                            double seconds, const std::stop_token& stop) {
  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  const auto passed_s = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
  while (!stop.stop_requested() && passed_s() < seconds) {
    watch.work();
    if (listener != nullptr) {
      listener->work();
    }
  }
  doctor::LaboratoryView view = watch.view();
  view.seconds = passed_s();
  if (listener != nullptr) {
    view.announced_by_multicast = listener->heard();
  }
  return view;
}

Expected<std::optional<BenchFile>> read_bench(const DoctorCommand& command,
                                              NetworkOptions& network) {
  if (command.bench_file.empty()) {
    return std::optional<BenchFile>();
  }
  auto bench = read_bench_file(command.bench_file);
  if (!bench) {
    return fail(bench.error());
  }
  add_network_settings(bench->network, network);
  return std::optional<BenchFile>(std::move(*bench));
}

// Null where multicast is not to be used, or cannot be; then a finding says so.
std::optional<doctor::AnnouncementListener> open_listener(const NetworkOptions& network,
                                                          Findings& findings) {
  if (network.no_multicast) {
    return std::nullopt;
  }
  const auto address = network.interface_name.empty()
                           ? Expected<std::string>(std::string())
                           : bus::interface_address(network.interface_name);
  if (address && address->starts_with("127.")) {
    return std::nullopt; // nothing is sent by multicast there
  }
  auto listener = doctor::AnnouncementListener::open(network.domain, address ? *address : "");
  if (!listener) {
    findings.push_back({Severity::warning, "multicast", listener.error().message});
    return std::nullopt;
  }
  return std::move(*listener);
}

// Nothing was looked at: neither a warning nor a problem.
int could_not_look(const Error& error) {
  constexpr int unknown = 3;
  const int status = report_error(error);
  return status == 1 ? unknown : status;
}

} // namespace

int run_doctor(const DoctorCommand& command, const std::stop_token& stop) {
  NetworkOptions network = command.network;
  const auto bench = read_bench(command, network);
  if (!bench) {
    return could_not_look(bench.error());
  }
  auto participant = join_network(network, "dyncal-doctor", {.watch_discovery = true});
  if (!participant) {
    return could_not_look(participant.error());
  }
  const auto own = this_program("dyncal-doctor", software_version(), network.dds);
  auto watch = doctor::LaboratoryWatch::open(*participant, own, bus::system_clock());
  if (!watch) {
    return could_not_look(watch.error());
  }
  Findings about_listener;
  auto listener = open_listener(network, about_listener);
  doctor::HostView host = doctor::look_at_host(".");
  doctor::LaboratoryView view =
      look(**watch, listener ? &*listener : nullptr, command.seconds, stop);
  host.udp_after = doctor::udp_counters();
  view.domain = network.domain;

  Findings findings = doctor::check_programs(view);
  append(findings, doctor::check_sources(view, *bench));
  append(findings, doctor::check_guards(view, *bench));
  append(findings, doctor::check_endpoints(view, *bench ? std::vector{(*bench)->bench}
                                                        : std::vector<std::string>()));
  append(findings, about_listener);
  append(findings, doctor::check_network(view));
  append(findings, doctor::check_loss(view));
  append(findings, doctor::check_host(host, network.domain));
  fmt::print("{}", command.json ? json_text(doctor::as_json(findings, view), 2) + "\n"
                                : doctor::as_text(findings));
  std::fflush(stdout);
  // At once: Cyclone DDS waits at its end for a packet that it sends to itself, and a firewall that
  // the doctor is to find may drop just that.
  std::_Exit(doctor::exit_status(findings));
}

} // namespace dyncal::services
