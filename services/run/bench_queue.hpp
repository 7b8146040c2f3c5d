// Which other run has a bench now, and waiting for its end (`dyncal run --wait`).
//
// A run lives as long as it repeats its Measurement in state PLANNED or RUNNING, every 2 s; one
// that has not for `alive_limit` has died, and the analysis gives its bench to the next. Of several
// runs that wait, the analysis takes one; the others are refused and wait again.
//
// Belongs to one thread.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "idl/dyncal.h"
#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"

namespace dyncal::inline run {

class BenchQueue {
public:
  static constexpr std::chrono::seconds alive_limit{5};
  static constexpr std::chrono::seconds listening_time{3}; // until a run that lives was heard

  // `clock` outlives the object. Fails (network) as readers do.
  [[nodiscard]] static Expected<BenchQueue> open(bus::Participant& participant, bus::Clock& clock,
                                                 const std::string& bench);

  // "run 'R1' of lab-pc:1234, since 2026-11-22 10:15:30 UTC"; nothing when no run is known to have
  // the bench.
  [[nodiscard]] std::optional<std::string> taken_by();

  // The same after `listening_time`, or as soon as one is heard.
  [[nodiscard]] std::optional<std::string> listen(const std::stop_token& stop);

  using Show = std::function<void(const std::string& phase)>;
  // Returns when nobody was heard for `listening_time`. Fails (interrupted) when a stop is
  // requested.
  [[nodiscard]] Expected<void> wait_until_free(const Show& show, const std::stop_token& stop);

private:
  struct Run {
    std::string conductor;
    bus::Clock::Instant heard;
  };

  BenchQueue(bus::Clock& clock, std::shared_ptr<bus::WakeUp> wake_up,
             bus::Reader<wire::Measurement> reader)
      : clock_(&clock), wake_up_(std::move(wake_up)), reader_(std::move(reader)) {}

  bus::Clock* clock_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  bus::Reader<wire::Measurement> reader_;
  std::map<std::string, Run> runs_; // that have not ended, by name
};

} // namespace dyncal::inline run
