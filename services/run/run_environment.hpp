// What a run is conducted with. All of it outlives the run; tests bring their own.
#pragma once

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/run/generator_connection.hpp"

namespace dyncal::inline run {

struct RunEnvironment {
  bus::Participant& participant;
  bus::Clock& clock = bus::system_clock();
  ConnectGenerator connect_generator = run::connect_generator;
};

} // namespace dyncal::inline run
