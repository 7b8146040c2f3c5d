// A laboratory as a command sees it: a participant of the bus that only listens and asks for
// clocks, and the state that services/live makes of what it hears. Belongs to one thread.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "services/live/laboratory.hpp"
#include "services/live/laboratory_readers.hpp"
#include "services/program/program.hpp"

namespace dyncal::services {

class WatchedLaboratory {
public:
  // `program` on the bus: "dyncal-watch"; `bench` "*": all. Fails (network).
  [[nodiscard]] static Expected<std::unique_ptr<WatchedLaboratory>>
  open(const NetworkOptions& network, const std::string& program, const std::string& bench);

  // Takes what has come; waits for it until then at most.
  void work(std::chrono::steady_clock::time_point until);

  [[nodiscard]] const live::Laboratory& laboratory() const { return laboratory_; }

private:
  WatchedLaboratory(bus::Participant participant, std::shared_ptr<bus::WakeUp> wake_up)
      : participant_(std::move(participant)), wake_up_(std::move(wake_up)),
        laboratory_(bus::system_clock()) {}

  bus::Participant participant_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  live::Laboratory laboratory_;
  std::optional<live::LaboratoryReaders> readers_; // of the participant
};

} // namespace dyncal::services
