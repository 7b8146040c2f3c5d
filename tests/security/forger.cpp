// A forger (tests/faults/forger.hpp) for campaigns: writes on a bench until it is told to end.
//
//   forger DDS DOMAIN BENCH ATTACK SOURCE FACTOR
//
// ATTACK is samples (of SOURCE, times FACTOR), results (times FACTOR), statuses (of the analysis'
// name where FACTOR is above 1), measurements, commands, or excitations. Says "forging" once it
// listens, and at its end, by SIGTERM, how many messages it has heard and forged.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include <fmt/core.h>

#include "tests/faults/forger.hpp"

namespace {

using dyncal::tests::Forger;

bool begin(Forger& forger, const std::string& attack, const std::string& source, double factor) {
  if (attack == "samples") {
    forger.send_as(source, factor);
  } else if (attack == "results") {
    forger.publish_results(factor);
  } else if (attack == "statuses") {
    forger.fail_runs(factor > 1.0);
  } else if (attack == "measurements") {
    forger.abort_runs();
  } else if (attack == "commands") {
    forger.command_to_abort();
  } else {
    return attack == "excitations";
  }
  return true;
}

bool ends(const sigset_t& signals) {
  const timespec now{};
  return sigtimedwait(&signals, nullptr, &now) == SIGTERM;
}

int forge(char** words) {
  sigset_t signals{};
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr); // in all threads: the library's come later
  Forger forger(words[1], std::atoi(words[2]), words[3]);
  const std::string attack = words[4];
  if (!begin(forger, attack, words[5], std::atof(words[6]))) {
    return 2;
  }
  fmt::print(stderr, "forging\n");
  std::size_t excitations = 0;
  bool ended = false;
  while (attack == "excitations" && excitations == 0 && !ended) {
    excitations = forger.hears_excitation(std::chrono::seconds(1)) ? 1 : 0;
    ended = ends(signals);
  }
  if (excitations > 0) {
    forger.hold_on();
  }
  int signal = 0;
  if (!ended) {
    sigwait(&signals, &signal);
  }
  forger.stop();
  fmt::print(stderr, "heard {} forged {}\n", forger.heard() + excitations,
             forger.forged() + excitations);
  return 0;
}

} // namespace

int main(int argc, char** argv) {
  try {
    return argc == 7 ? forge(argv) : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
