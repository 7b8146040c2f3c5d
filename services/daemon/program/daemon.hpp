// What every daemon of a laboratory does alike: its command line, log, signals, participant, the
// answers to who asks for its clock, and what it reports of itself to systemd and Prometheus.
//
// run_daemon() is the body of main(): it reads the command line, sets up the log and calls `serve`,
// which joins the network once it knows with what options, serves until stop(), and returns. A
// program that serves bench files uses run_bench_program() (bench_program.hpp) instead.
//
// Threads: join() from the one that called `serve`, the others from any after that.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/contract/program_identity.hpp"
#include "services/daemon/program/program.hpp"

namespace dyncal::inline host_clocks {
class ClockResponder;
}

namespace dyncal::inline daemon {

class Daemon;
class Supervisor;
class WatchedNetwork;

struct DaemonProgram {
  std::string name;        // "dyncal-dau"
  std::string description; // one sentence, for --help
  LogWriting log = LogWriting::at_once;
  std::function<void(CLI::App&)> add_options{}; // of its own; may be empty
  // Blocks until daemon.stop(). What it returns is the end of the program.
  std::function<Expected<void>(Daemon& daemon)> serve;
};

class Daemon {
public:
  Daemon(std::string name, NetworkOptions options, std::unique_ptr<Supervisor> supervisor,
         const std::stop_token& signals);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  // As the command line has it; a bench file may add to it before join().
  NetworkOptions network;

  // Joins the network and answers who asks for this program and its clock. Fails (network) as
  // join_network() does.
  [[nodiscard]] Expected<void> join();
  // REQUIRES: joined.
  [[nodiscard]] bus::Participant& participant();
  // Requested by a signal, and once joined also when nobody hears the program any more.
  [[nodiscard]] std::stop_token stop() const;
  [[nodiscard]] Supervisor& supervisor() { return *supervisor_; }
  [[nodiscard]] const ProgramIdentity& identity() const;
  // Whoever is on its network can read and send everything: it is not secured, and more than
  // loopback.
  [[nodiscard]] bool is_open_to_others() const;
  // As WatchedNetwork::strangers(). REQUIRES: joined.
  [[nodiscard]] std::string strangers() const;
  // One turn of the main loop: what the network refused is reported with it. REQUIRES:
  // participant() was not moved from; who does that reports to supervisor().
  void turned();
  // `served`, the last word of the program, as WatchedNetwork::outcome().
  [[nodiscard]] Expected<void> outcome(Expected<void> served) const;

private:
  std::string name_;
  std::stop_token signals_;
  std::unique_ptr<Supervisor> supervisor_;
  std::unique_ptr<WatchedNetwork> joined_;
  std::shared_ptr<const bus::RefusedPackets> refused_;
  std::unique_ptr<ClockResponder> clock_;
  std::optional<std::stop_callback<std::function<void()>>> stopping_;
};

// The body of main(). Returns the exit status.
[[nodiscard]] int run_daemon(int argc, char** argv, const DaemonProgram& program);

} // namespace dyncal::inline daemon
