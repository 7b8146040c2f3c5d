// What others have asked the conductor of a run to do, by Command messages to the target
// "conductor": pause, continue, end the run, excite a step once more.
//
// Commands of other runs and to other targets are left out. Who commands repeats it until its
// effect shows, so each may come more than once. Belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "idl/dyncal.h"
#include "services/bus/bus.hpp"
#include "services/error.hpp"

namespace dyncal::services {

class RunCommands {
public:
  // Fails (network) as readers do.
  [[nodiscard]] static Expected<RunCommands> open(bus::Participant& participant,
                                                  const std::string& bench, std::string run,
                                                  const std::shared_ptr<bus::WakeUp>& wake_up);

  void take();
  // The sender of the command, "?" without a name.
  [[nodiscard]] const std::optional<std::string>& paused_by() const { return paused_by_; }
  [[nodiscard]] const std::optional<std::string>& aborted_by() const { return aborted_by_; }
  // The steps to be excited once more that were asked for since the last call.
  [[nodiscard]] std::set<std::uint32_t> take_repeats();

private:
  RunCommands(std::string run, bus::Reader<wire::Command> reader)
      : run_(std::move(run)), reader_(std::move(reader)) {}
  void obey(const wire::Command& command);

  std::string run_;
  bus::Reader<wire::Command> reader_;
  std::optional<std::string> paused_by_;
  std::optional<std::string> aborted_by_;
  std::set<std::uint32_t> repeats_;
};

} // namespace dyncal::services
