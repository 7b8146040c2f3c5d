// The messages that a network::BusState is fed with, from DDS: readers of states and results, and
// the exchange of clocks that tells which programs are there. No samples are read.
//
// Belongs to one thread, which calls work() when the wake-up rings, at least twice a second.
#pragma once

#include <memory>
#include <string>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/bus/host_clocks/clock_asker.hpp"
#include "services/contract/program_identity.hpp"
#include "services/network/bus_state.hpp"

namespace dyncal::network {

class BusReaders {
public:
  // `bench`: of one bench, "*": of all. `own`: who asks for clocks. Fails (network) as readers and
  // writers do. `clock` outlives the object.
  [[nodiscard]] static Expected<BusReaders> open(bus::Participant& participant,
                                                 const std::string& bench,
                                                 const ProgramIdentity& own, bus::Clock& clock,
                                                 const std::shared_ptr<bus::WakeUp>& wake_up);

  // Feeds what has come, and asks for clocks when it is time.
  void work(BusState& state);

private:
  struct Readers {
    bus::Reader<wire::SourceDescription> descriptions;
    bus::Reader<wire::SourceStatus> sources;
    bus::Reader<wire::Measurement> measurements;
    bus::Reader<wire::Excitation> excitation;
    bus::Reader<wire::ServiceStatus> services;
    bus::Reader<wire::ServiceStatus> recorders;
    bus::Reader<wire::CalibrationResult> results;
    bus::Reader<wire::TransferFunction> functions;
    bus::Reader<wire::SampleClockReport> clocks;
  };

  BusReaders(Readers readers, ClockAsker asker)
      : readers_(std::move(readers)), asker_(std::move(asker)) {}

  Readers readers_;
  ClockAsker asker_;
};

} // namespace dyncal::network
