// What a daemon reports of itself while it runs: one object in each program, to which its main loop
// speaks; systemd (service_manager.hpp) and Prometheus (metrics_server.hpp) are behind it.
//
// "The main loop" is the thread without which the daemon serves nobody: of a source program the
// publishing thread, of the analysis the one that serves runs. Threads: describe(), serving() and
// stopping() from main; turned() from the main loop; the reports from any.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "services/base/error.hpp"
#include "services/contract/program_identity.hpp"
#include "services/daemon/supervision/daemon_metrics.hpp"
#include "services/daemon/supervision/metric_store.hpp"
#include "services/daemon/supervision/metrics_server.hpp"
#include "services/daemon/supervision/service_manager.hpp"

namespace dyncal::inline daemon {

class Supervisor {
public:
  // `metrics_address` is where metrics are served; empty: nowhere. Fails as MetricsServer does.
  [[nodiscard]] static Expected<std::unique_ptr<Supervisor>>
  create(ProgramIdentity identity, const std::string& metrics_address);

  // Of this program. Any thread.
  [[nodiscard]] const ProgramIdentity& identity() const { return identity_; }
  // One line for people, e.g. "bench acc-1"; before serving().
  void describe(std::string status) { status_ = std::move(status); }
  // For the log, once the daemon serves: one that fails before says why, and nothing else.
  void say_when_serving(std::string line) { line_ = std::move(line); }
  // The daemon serves from the next turn of its main loop on.
  void serving();
  // One turn of the main loop, which turns at least twice a second.
  void turned() { manager_.turned(); }
  void stopping() { manager_.stopping(); }

  // Figures that are served to nobody are left out: a main loop may report them a thousand times a
  // second.
  void report(const wire::SourceStatus& status, std::uint64_t messages_written) {
    if (server_) {
      daemon::report(status, messages_written, store_);
    }
  }
  template <class Figures>
  void report(const Figures& figures) {
    if (server_) {
      daemon::report(figures, store_);
    }
  }
  void report_malformed_messages(std::uint64_t count) {
    if (server_) {
      daemon::report_malformed_messages(count, store_);
    }
  }
  void report_refused_packets(std::uint64_t count) {
    if (server_) {
      daemon::report_refused_packets(count, store_);
    }
  }

private:
  explicit Supervisor(ProgramIdentity identity) : identity_(std::move(identity)) {}

  ProgramIdentity identity_;
  std::string status_;
  std::string line_; // empty: nothing
  ServiceManager manager_;
  MetricStore store_;
  std::unique_ptr<MetricsServer> server_; // of store_; null: nobody asked for it
};

} // namespace dyncal::inline daemon
