// An end of bus_speed.py on the bus, as dyncal's programs use it.
//
//   bus_speed_end write|read DOMAIN BYTES BLOCKS DDS mixed|same
#include <chrono>
#include <cstdio>
#include <exception>
#include <memory>
#include <string_view>

#include "services/bus/bus.hpp"
#include "services/contract/topics.hpp"
#include "speed_end.h"
#include "tests/patience.hpp"

namespace {

using namespace dyncal;

bus::Participant join(const SpeedOptions& options, int argc, char** argv) {
  bus::ParticipantOptions participant;
  participant.vendor = bus::parse_vendor(argc > 5 ? argv[5] : "").value();
  participant.laboratory = argc > 6 && std::string_view(argv[6]) == "same"
                               ? bus::LaboratoryVendors::same
                               : bus::LaboratoryVendors::mixed;
  participant.interface_name = "lo";
  participant.domain = options.domain;
  participant.name = "bus speed";
  return bus::Participant::create(participant).value();
}

int write_blocks(const SpeedOptions& options, bus::Participant& participant) {
  auto writer =
      participant
          .writer<wire::SampleBlock>(SPEED_TOPIC, bus::Profile::paced_samples, SPEED_PARTITION)
          .value();
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  while (writer.matched_readers() == 0 && std::chrono::steady_clock::now() < deadline) {
    bus::WakeUp().wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(5));
  }
  wire::SampleBlock block;
  block.bench(SPEED_PARTITION);
  block.source("dau");
  block.values().resize(options.bytes / sizeof(double));
  for (std::size_t number = 1; number <= options.blocks; ++number) {
    block.block(number);
    block.origin_ns(monotonic_ns());
    while (writer.write(block) == bus::WriteOutcome::timed_out) {
    }
  }
  writer.wait_for_acknowledgments(tests::patience);
  return report_writing();
}

int read_blocks(const SpeedOptions& options, bus::Participant& participant) {
  const auto bell = std::make_shared<bus::WakeUp>();
  auto reader =
      participant
          .reader<wire::SampleBlock>(SPEED_TOPIC, bus::Profile::live_samples, SPEED_PARTITION, bell)
          .value();
  Arrivals arrivals = await_arrivals(&options);
  while (is_awaited(&arrivals)) {
    bell->wait_until(std::chrono::steady_clock::now() + std::chrono::seconds(1));
    reader.take(
        [&](const wire::SampleBlock& block) { note_arrival(&arrivals, block.origin_ns()); });
  }
  return report_arrivals(&arrivals);
}

} // namespace

int main(int argc, char** argv) try {
  const SpeedOptions options = speed_options_of(argc, argv);
  bus::Participant participant = join(options, argc, argv);
  return options.writes ? write_blocks(options, participant) : read_blocks(options, participant);
} catch (const std::exception& problem) {
  std::fprintf(stderr, "bus_speed_end: %s\n", problem.what());
  return 1;
}
