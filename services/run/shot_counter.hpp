// Counts the shots of the step that is being measured: pairs of an oscilloscope's and a sensor's
// record with the same session and number that name the step and its attempt. `dyncal run` excites
// a step until it has the shots that the recipe asks for. Belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "idl/dyncal.h"
#include "services/base/error.hpp"
#include "services/bus/bus.hpp"

namespace dyncal::inline run {

class ShotCounter {
public:
  [[nodiscard]] static Expected<ShotCounter> create(bus::Participant& participant,
                                                    const std::string& bench,
                                                    const std::shared_ptr<bus::WakeUp>& wake_up);

  // Forgets what has been counted.
  void begin(const std::string& run, std::uint32_t step, std::uint32_t attempt);
  [[nodiscard]] int shots();

private:
  using Numbers = std::set<std::pair<std::uint64_t, std::uint64_t>>; // session, shot
  ShotCounter(bus::Reader<wire::TriggeredRecord> traces, bus::Reader<wire::TriggeredRecord> series)
      : traces_(std::move(traces)), series_(std::move(series)) {}
  void take(bus::Reader<wire::TriggeredRecord>& reader, Numbers& numbers) const;

  bus::Reader<wire::TriggeredRecord> traces_;
  bus::Reader<wire::TriggeredRecord> series_;
  std::string run_;
  std::uint32_t step_ = 0;
  std::uint32_t attempt_ = 1;
  Numbers trace_numbers_;
  Numbers series_numbers_;
};

} // namespace dyncal::inline run
