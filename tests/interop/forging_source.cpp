// A program that writes samples on a bench and describes no source there, until it is ended.
//
//   forging_source DDS DOMAIN BENCH
#include <csignal>
#include <cstdlib>
#include <string>

#include "services/bus/bus.hpp"
#include "services/bus/vendor.hpp"
#include "services/contract/topics.hpp"

int main(int count, char** words) {
  namespace bus = dyncal::bus;
  if (count != 4) {
    return 2;
  }
  sigset_t ending;
  sigemptyset(&ending);
  sigaddset(&ending, SIGTERM);
  sigprocmask(SIG_BLOCK, &ending, nullptr); // of its threads, too
  bus::ParticipantOptions options;
  options.vendor =
      std::string(words[1]) == "fastdds" ? bus::Vendor::fast_dds : bus::Vendor::cyclone_dds;
  options.domain = std::atoi(words[2]);
  options.name = "forger";
  auto participant = bus::Participant::create(options);
  const auto writer = participant.and_then(
      [&](bus::Participant& joined) { return joined.writer(bus::topics::dau_samples, words[3]); });
  int signal = 0;
  return writer ? sigwait(&ending, &signal) : 1;
}
