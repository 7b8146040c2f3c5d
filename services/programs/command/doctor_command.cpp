#include "services/programs/command/doctor_command.hpp"

#include <cstdio>
#include <cstdlib>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/report.hpp"
#include "services/checks/doctor/unheard_analysis.hpp"
#include "services/daemon/program/bench_program.hpp"
#include "services/programs/command/laboratory_look.hpp"

namespace dyncal::inline programs {
namespace {

Expected<std::optional<BenchFile>> read_bench(const DoctorCommand& command,
                                              NetworkOptions& network) {
  if (command.bench_file.empty()) {
    return std::optional<BenchFile>();
  }
  DYNCAL_TRY(auto bench, read_bench_file(command.bench_file));
  add_network_settings(bench.network, network);
  return std::optional<BenchFile>(std::move(bench));
}

Findings judge(const LaboratoryLook& look, const std::optional<BenchFile>& bench) {
  const doctor::LaboratoryView& view = look.view;
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
  append(findings, doctor::check_loss(view));
  append(findings, doctor::check_host(look.host, view.domain));
  return findings;
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
  const auto looked =
      look_at_laboratory(network, command.seconds, stop, [&](const LaboratoryLook& look) {
        const Findings findings = judge(look, *bench);
        fmt::print("{}", command.json ? json_text(doctor::as_json(findings, look.view), 2) + "\n"
                                      : doctor::as_text(findings));
        std::fflush(stdout);
        std::_Exit(doctor::exit_status(findings));
      });
  return could_not_look(looked.error());
}

} // namespace dyncal::inline programs
