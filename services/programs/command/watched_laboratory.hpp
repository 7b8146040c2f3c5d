// A laboratory as a command sees it: a participant of the bus that only listens and asks for
// clocks, and the state that services/network makes of what it hears. Belongs to one thread.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "services/daemon/program/program.hpp"
#include "services/network/bus_readers.hpp"
#include "services/network/bus_state.hpp"

namespace dyncal::inline daemon {
class WatchedNetwork;
}

namespace dyncal::inline programs {

class WatchedLaboratory {
public:
  // `program` on the bus: "dyncal-watch"; `bench` "*": all; until `asked`. Fails (network).
  [[nodiscard]] static Expected<std::unique_ptr<WatchedLaboratory>>
  open(const NetworkOptions& network, const std::string& program, const std::string& bench,
       const std::stop_token& asked);
  ~WatchedLaboratory();
  WatchedLaboratory(const WatchedLaboratory&) = delete;
  WatchedLaboratory& operator=(const WatchedLaboratory&) = delete;

  // Takes what has come; waits for it until then at most.
  void work(std::chrono::steady_clock::time_point until);

  [[nodiscard]] const network::BusState& laboratory() const { return laboratory_; }
  // As WatchedNetwork::strangers().
  [[nodiscard]] std::string strangers() const;
  // Nothing more is heard of the laboratory, or the end was asked for.
  [[nodiscard]] bool is_over() const;
  // Fails (network) where nothing more is heard.
  [[nodiscard]] Expected<void> outcome() const;

private:
  WatchedLaboratory(std::unique_ptr<WatchedNetwork> network, std::shared_ptr<bus::WakeUp> wake_up);

  std::unique_ptr<WatchedNetwork> network_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  network::BusState laboratory_;
  std::optional<network::BusReaders> readers_; // of its participant
};

} // namespace dyncal::inline programs
