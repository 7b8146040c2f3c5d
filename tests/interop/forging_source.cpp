// A program that sends samples in the name of a source of another program, until it is ended.
//
//   forging_source DDS DOMAIN BENCH SOURCE
#include <csignal>
#include <cstdlib>

#include "tests/faults/forger.hpp"

int main(int count, char** words) {
  if (count != 5) {
    return 2;
  }
  sigset_t ending;
  sigemptyset(&ending);
  sigaddset(&ending, SIGTERM);
  sigprocmask(SIG_BLOCK, &ending, nullptr); // of its threads, too
  dyncal::tests::Forger forger(words[1], std::atoi(words[2]), words[3]);
  forger.send_as(words[4]);
  int signal = 0;
  return sigwait(&ending, &signal);
}
