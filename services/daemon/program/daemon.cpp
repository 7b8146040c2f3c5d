#include "services/daemon/program/daemon.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "services/base/version.hpp"
#include "services/bus/host_clocks/clock_messages.hpp"
#include "services/bus/host_clocks/clock_responder.hpp"
#include "services/bus/host_network.hpp"
#include "services/daemon/program/command_line.hpp"
#include "services/daemon/program/watched_network.hpp"
#include "services/daemon/supervision/supervisor.hpp"

namespace dyncal::inline daemon {
namespace {

// By the interface that was named, or any.
bool reaches_other_hosts(const std::string& interface_name) {
  const auto addresses = bus::host_addresses().value_or(std::vector<bus::HostAddress>());
  return std::ranges::any_of(addresses, [&](const bus::HostAddress& one) {
    return !one.loopback && (interface_name.empty() || interface_name == one.interface ||
                             interface_name == one.address);
  });
}

} // namespace

Daemon::Daemon(std::string name, NetworkOptions options, std::unique_ptr<Supervisor> supervisor,
               const std::stop_token& signals)
    : network(std::move(options)), name_(std::move(name)), signals_(signals),
      supervisor_(std::move(supervisor)) {
  stopping_.emplace(signals_, [this] { supervisor_->stopping(); });
}

Daemon::~Daemon() = default;

bus::Participant& Daemon::participant() {
  return joined_->participant;
}

std::stop_token Daemon::stop() const {
  return joined_ ? joined_->stop() : signals_;
}

const ProgramIdentity& Daemon::identity() const {
  return supervisor_->identity();
}

Expected<void> Daemon::join() {
  DYNCAL_TRY(joined_, WatchedNetwork::join(network, name_, signals_));
  stopping_.emplace(joined_->stop(), [this] { supervisor_->stopping(); });
  if (is_open_to_others()) {
    supervisor_->say_when_serving("not secured: whoever is on this network can read and send "
                                  "everything (--security)");
  }
  refused_ = joined_->participant.refused_packets();
  DYNCAL_TRY(clock_, ClockResponder::start(joined_->participant, identity()));
  return {};
}

bool Daemon::is_open_to_others() const {
  return network.security.empty() && reaches_other_hosts(network.interface_name);
}

std::string Daemon::strangers() const {
  return joined_->strangers();
}

void Daemon::turned() {
  supervisor_->report_refused_packets(refused_->count());
  supervisor_->report_malformed_messages(joined_->participant.malformed_messages());
  supervisor_->turned();
}

Expected<void> Daemon::outcome(Expected<void> served) const {
  return joined_ ? joined_->outcome(std::move(served)) : served;
}

int run_daemon(int argc, char** argv, const DaemonProgram& program) {
  CLI::App app{program.description, program.name};
  app.set_version_flag("--version", build_description());
  NetworkOptions network;
  std::string metrics;
  if (program.add_options) {
    program.add_options(app);
  }
  add_network_options(app, network);
  add_metrics_option(app, metrics);
  if (const auto status = read_command_line(app, argc, argv)) {
    return *status;
  }
  set_up_log(program.name, program.log);
  const std::stop_token signals = stop_on_signals(); // before there are threads that would take one
  auto supervisor =
      Supervisor::create(this_program(program.name, software_version(), network.dds), metrics);
  if (!supervisor) {
    return report_error(supervisor.error());
  }
  const auto served = [&] { // what it made ends before the log does
    Daemon daemon(program.name, std::move(network), std::move(*supervisor), signals);
    return daemon.outcome(program.serve(daemon));
  }();
  if (!served) {
    return report_error(served.error());
  }
  spdlog::info("stopped");
  finish_log();
  return EXIT_SUCCESS;
}

} // namespace dyncal::inline daemon
