// What every program of dyncal does alike: options of the network, log lines, stopping on signals,
// one line for what went wrong.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/daemon/program/log.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
}

namespace dyncal::inline daemon {

struct NetworkOptions {
  std::string dds;               // as parse_vendor() takes it
  std::string vendors = "mixed"; // "mixed" or "same"
  int domain = 0;
  std::vector<std::string> peers;
  bool no_multicast = false;
  std::string interface_name;
  std::string security; // folder (services/security/identity_folder.hpp); empty: not secured
};

// --dds, --vendors, --domain, --peer, --no-multicast, --interface, --security
void add_network_options(CLI::App& app, NetworkOptions& options);

// --metrics ADDRESS:PORT, for programs that run for long; empty: not given.
void add_metrics_option(CLI::App& app, std::string& address);

// What only some programs ask of the network.
struct NetworkUse {
  bool watch_discovery = false; // Participant::discovered()
};

// Warnings of the network go to the log. Fails (bad_file) before anything is sent where the folder
// of --security is wrong.
[[nodiscard]] Expected<bus::Participant>
join_network(const NetworkOptions& options, const std::string& program, const NetworkUse& use = {});

// Stopped once SIGINT, SIGTERM or SIGHUP has come, the last unless it is ignored (nohup); SIGINT or
// SIGTERM after that ends the process at once. REQUIRES: called once, before other threads start,
// since the signals are blocked in all threads and waited for in one of their own, which lasts as
// long as the process.
[[nodiscard]] std::stop_token stop_on_signals();

// Blocks until `stop` is requested.
void wait_for_stop(const std::stop_token& stop);

// Finishes the log, prints "PROGRAM: message" on standard error and returns the exit status that
// belongs to the error.
[[nodiscard]] int report_error(const Error& error);

} // namespace dyncal::inline daemon
