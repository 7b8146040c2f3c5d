#include "services/daemon/program/program.hpp"

#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "services/base/printable_text.hpp"
#include "services/daemon/program/secured_network.hpp"

namespace dyncal::inline daemon {
namespace {

constexpr int interrupted_status = 130; // 128 + SIGINT, as shells report it

// Any name is taken; parse_vendor() judges it, so that the sentence is the same everywhere.
CLI::Validator vendor_validator() {
  std::string names;
  for (const bus::Vendor vendor : bus::vendors_in_this_build()) {
    names += (names.empty() ? "" : ",") + to_string(vendor);
  }
  return {[](const std::string& name) {
            const auto vendor = bus::parse_vendor(name);
            return vendor ? std::string() : vendor.error().message;
          },
          "{" + names + "}", "vendor"};
}

// As a program under nohup has it.
bool is_ignored(int signal) {
  struct sigaction present {};
  return sigaction(signal, nullptr, &present) == 0 && present.sa_handler == SIG_IGN;
}

} // namespace

void add_network_options(CLI::App& app, NetworkOptions& options) {
  if (const auto vendors = bus::vendors_in_this_build(); !vendors.empty()) {
    options.dds = to_string(vendors.front());
  }
  app.add_option("--dds", options.dds, "DDS implementation that carries the messages")
      ->check(vendor_validator())
      ->capture_default_str();
  app.add_option("--vendors", options.vendors,
                 "same: every program of the laboratory, of other tools as well, has the "
                 "implementation of --dds, and packets are as long as the network carries")
      ->envname("DYNCAL_VENDORS")
      ->check(CLI::IsMember({"mixed", "same"}))
      ->capture_default_str();
  app.add_option("--domain", options.domain, "DDS domain: one per laboratory")
      ->envname("DYNCAL_DOMAIN")
      ->check(CLI::Range(0, 232))
      ->capture_default_str();
  app.add_option("--peer", options.peers,
                 "address of another host, where the network has no multicast (repeatable)");
  app.add_flag("--no-multicast", options.no_multicast, "find others by --peer alone");
  app.add_option("--interface", options.interface_name,
                 "network interface to use (name or address)");
  app.add_option("--security", options.security,
                 "folder that 'dyncal security issue' made for this program: everything is "
                 "encrypted, and only who has such a folder takes part")
      ->envname("DYNCAL_SECURITY");
}

void add_metrics_option(CLI::App& app, std::string& address) {
  app.add_option("--metrics", address,
                 "serve metrics for Prometheus at ADDRESS:PORT, e.g. 127.0.0.1:9464 (default: no)");
}

Expected<bus::Participant> join_network(const NetworkOptions& options, const std::string& program,
                                        const NetworkUse& use) {
  if (!options.security.empty()) {
    DYNCAL_TRY(auto joined, join_secured_network(options, program, use));
    return std::move(joined.participant);
  }
  DYNCAL_TRY(const auto participant, participant_options(options, program, use));
  return bus::Participant::create(participant);
}

namespace {

std::atomic<pthread_t> waiting_thread;

void hand_to_waiting_thread(int signal) {
  pthread_kill(waiting_thread.load(), signal);
}

// Libraries may have threads of their own before main() begins, as OpenBLAS has, which block
// nothing: a signal that one of them is given would end the program at once.
void take_from_foreign_threads(const sigset_t& signals) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    struct sigaction now {};
    now.sa_handler = hand_to_waiting_thread;
    now.sa_flags = SA_RESTART;
    sigemptyset(&now.sa_mask);
    if (sigismember(&signals, signal) == 1 && sigaction(signal, nullptr, &before) == 0 &&
        before.sa_handler == SIG_DFL) {
      sigaction(signal, &now, nullptr);
    }
  }
}

} // namespace

std::stop_token stop_on_signals() {
  sigset_t asks_again;
  sigemptyset(&asks_again);
  sigaddset(&asks_again, SIGINT);
  sigaddset(&asks_again, SIGTERM);
  sigset_t signals = asks_again;
  if (!is_ignored(SIGHUP)) {
    sigaddset(&signals, SIGHUP);
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::stop_source stop;
  std::thread waiting([signals, asks_again, stop]() mutable {
    int signal = 0;
    sigwait(&signals, &signal);
    stop.request_stop();
    // A terminal that is closed says so more than once.
    sigwait(&asks_again, &signal);
    _exit(interrupted_status);
  });
  waiting_thread = waiting.native_handle();
  waiting.detach();
  take_from_foreign_threads(signals);
  return stop.get_token();
}

void wait_for_stop(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  stopped.wait(lock, stop, [] { return false; });
}

int report_error(const Error& error) {
  finish_log();
  const std::string& program = spdlog::default_logger()->name();
  fmt::print(stderr, "{}: {}\n", program.empty() ? "dyncal" : program, one_line(error.message));
  return error.code == ErrorCode::interrupted    ? interrupted_status
         : error.code == ErrorCode::bad_argument ? 2
                                                 : 1;
}

} // namespace dyncal::inline daemon
