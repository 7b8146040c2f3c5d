// What a program of the first contract left on the bus: it describes itself once as a source, with
// a channel of its own, without host, process and status, and ends or is killed.
//
//   older_source DDS DOMAIN BENCH SOURCE SECONDS
//
// Says "described" on standard error once a reader has it, and lives for SECONDS more.
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "idl/dyncal.h"
#include "services/bus/bus.hpp"
#include "services/contract/session_number.hpp"

namespace {

using namespace dyncal;
using namespace std::chrono_literals;

wire::SourceDescription description(const char* bench, const char* source) {
  wire::SourceDescription description;
  description.bench(bench);
  description.source(source);
  description.session(contract::random_session());
  description.kind(wire::SOURCE_DAU);
  description.contract_version(1);
  description.nominal_rate_hz(500.0);
  wire::ChannelDescription channel;
  channel.name("voltage");
  channel.quantity("voltage");
  channel.unit("V");
  channel.minimum(-1.0);
  channel.maximum(1.0);
  description.channels().push_back(channel);
  return description;
}

int describe(char** words) {
  bus::ParticipantOptions options;
  const auto vendor = bus::parse_vendor(words[1]);
  if (!vendor) {
    return 2;
  }
  options.vendor = *vendor;
  options.domain = std::atoi(words[2]);
  options.name = "older-source";
  auto participant = bus::Participant::create(options);
  if (!participant) {
    return 1;
  }
  auto writer = participant->writer(bus::topics::source_description, words[3]);
  if (!writer || writer->write(description(words[3], words[4])) != bus::WriteOutcome::written) {
    return 1;
  }
  const auto until = std::chrono::steady_clock::now() + 60s;
  while (writer->matched_readers() == 0 && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(10ms); // between two looks
  }
  if (!writer->wait_for_acknowledgments(10s) || writer->matched_readers() == 0) {
    return 1;
  }
  std::fputs("described\n", stderr);
  std::this_thread::sleep_for(std::chrono::duration<double>(std::atof(words[5]))); // as long
  return 0;
}

} // namespace

int main(int argc, char** argv) {
  return argc == 6 ? describe(argv) : 2;
}
