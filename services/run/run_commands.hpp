// What others have asked the conductor of a run to do, by Command messages to the target
// "conductor": pause, continue, end the run, excite a step once more.
//
// Commands of other runs and to other targets are left out. Who commands repeats it until its
// effect shows, so each may come more than once, even after the effect: a step that has begun again
// meanwhile is not asked for once more by the last of them. Commands of one sender for one step are
// one command while they come within `repetition_limit` of each other. Belongs to one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "idl/dyncal.h"
#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"

namespace dyncal::services {

class RunCommands {
public:
  static constexpr std::chrono::seconds repetition_limit{2};

  // Fails (network) as readers do. `clock` outlives the object.
  [[nodiscard]] static Expected<RunCommands> open(bus::Participant& participant, bus::Clock& clock,
                                                  const std::string& bench, std::string run,
                                                  const std::shared_ptr<bus::WakeUp>& wake_up);

  void take();
  // The sender of the command, "?" without a name.
  [[nodiscard]] const std::optional<std::string>& paused_by() const { return paused_by_; }
  [[nodiscard]] const std::optional<std::string>& aborted_by() const { return aborted_by_; }
  // The steps to be excited once more that were asked for since the last call.
  [[nodiscard]] std::set<std::uint32_t> take_repeats();

private:
  RunCommands(bus::Clock& clock, std::string run, bus::Reader<wire::Command> reader)
      : clock_(&clock), run_(std::move(run)), reader_(std::move(reader)) {}
  void obey(const wire::Command& command);
  void ask_for(std::uint32_t step, const std::string& sender);

  bus::Clock* clock_;
  std::string run_;
  bus::Reader<wire::Command> reader_;
  std::optional<std::string> paused_by_;
  std::optional<std::string> aborted_by_;
  std::set<std::uint32_t> repeats_;
  std::map<std::pair<std::string, std::uint32_t>, bus::Clock::Instant> asked_; // last, by sender
};

} // namespace dyncal::services
